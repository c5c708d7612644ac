// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause

// A configuration: parsed, read into parameters, and what is in force read again.
#include "engram/base/config.h"
#include "engram/sources/rawlog_source.h"
#include "fuzz_input.h"

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace engram;
  const std::string text = fuzz::text({data, size});
  fuzz::mayRefuse([&] {
    sources::RawlogParams params;
    base::Config config;
    config.bind("source", params);
    base::IniFile ini = base::IniFile::parse(text, "fuzz.ini");
    ini.override("source.look_ahead=3");
    config.read(ini);
    const std::string dumped = config.dump();
    try {
      config.read(base::IniFile::parse(dumped, "dump.ini"));
    } catch (const base::Error&) {
      std::abort();  // what we write we read
    }
  });
  fuzz::mayRefuse([&] { base::IniFile::parse({}, "empty.ini").override(text); });
  return 0;
}
