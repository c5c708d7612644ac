// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/atomic_file.h"

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <unistd.h>

namespace engram::base {
namespace {

namespace fs = std::filesystem;

/// A temporary file with a name of its own, for a writer that wants a name and cannot write to a pipe.
class Detour {
 public:
  explicit Detour(const std::string& path) {
    const std::string end = path == kStandardOutput ? "" : fs::path(path).filename().string();
    std::string name = (fs::temp_directory_path() / "engram-XXXXXX").string() + end;
    const int descriptor = ::mkostemps(name.data(), static_cast<int>(end.size()), 0);
    if (descriptor < 0) throw Error("cannot write '" + name + "': " + reasonOf(errno));
    ::close(descriptor);
    name_ = name;
  }
  ~Detour() { ::unlink(name_.c_str()); }
  Detour(const Detour&) = delete;
  Detour& operator=(const Detour&) = delete;

  const std::string& name() const { return name_; }
  void copyTo(OutputFile& file) const {
    std::ifstream in(name_, std::ios::binary);
    std::string chunk(1 << 16, '\0');
    while (in.read(chunk.data(), static_cast<std::streamsize>(chunk.size())) || in.gcount() > 0)
      file.write({chunk.data(), static_cast<std::size_t>(in.gcount())});
  }

 private:
  std::string name_;
};

void callWriter(const std::string& path, const std::string& name,
                const std::function<void(const std::string&)>& write) {
  try {
    write(name);
  } catch (const Error& e) {
    throw Error("cannot write '" + path + "': " + e.what());
  }
}

}  // namespace

void writeAtomically(const std::string& path, bool overwrite,
                     const std::function<void(const std::string&)>& write) {
  OutputFile file(path, overwrite);
  if (file.temporary().empty()) {
    const Detour detour(path);
    callWriter(path, detour.name(), write);
    detour.copyTo(file);
  } else {
    callWriter(path, file.temporary(), write);
  }
  file.commit();
}

void writeText(const std::string& path, std::string_view text, bool overwrite, Sync sync) {
  OutputFile file(path, overwrite);
  file.write(text);
  file.commit(sync);
}

}  // namespace engram::base
