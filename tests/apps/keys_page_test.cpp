// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// docs/keys.md is made from what the parameters say of themselves. ENGRAM_UPDATE_DOCS=1 writes it anew.
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/text_file.h"
#include "engram/capture/gige_params.h"
#include "engram/pipeline/params.h"
#include "engram/sources/rawlog_source.h"
#include "engram/world/world.h"
#include "eval_program.h"
#include "program_run.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <sstream>

namespace engram::apps {
namespace {

/// A vertical bar would end the cell.
std::string cell(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.insert(at, "\\");
  return text;
}

/// A dump as tables, without the sections that are there already.
std::string tables(const std::string& dump, std::set<std::string>& sections) {
  std::ostringstream out;
  std::istringstream in(dump);
  std::string help;
  bool wanted = false;
  for (std::string line; std::getline(in, line);) {
    if (line.starts_with("[")) {
      wanted = sections.insert(line).second;
      if (wanted) out << "\n### `" << line << "`\n\n| key | default | meaning |\n|---|---|---|\n";
    } else if (line.starts_with("# ")) {
      help = line.substr(2);
    } else if (const auto equals = line.find(" ="); equals != std::string::npos && wanted) {
      const std::string value = line.substr(std::min(line.size(), equals + 3));
      out << "| `" << line.substr(0, equals) << "` | " << (value.empty() ? "" : "`" + cell(value) + "`")
          << " | " << cell(help) << " |\n";
    }
  }
  return out.str();
}

std::string page() {
  base::Config run, camera, simulator;
  sources::RawlogParams source;
  pipeline::PipelineParams pipeline;
  capture::GigeParams front;
  world::WorldParams world;
  run.bind("source", source);
  pipeline.bind(run);
  camera.bind("front", front);
  simulator.bind("change", world.change);
  simulator.bind("drive", world.drive);
  simulator.bind("sensor", world.sensor);

  std::set<std::string> sections;
  std::string text =
      "# Keys\n\nEvery key of a configuration: its default and its meaning. Made from the programs; a test "
      "holds the two "
      "together.\n`--dump-config` prints those in force, and which of them are without effect.\n\n"
      "## engram-slam and engram-localize\n" +
      tables(run.dump(), sections) +
      "\n## A live camera\n\nThe section has any name; `front` is that of the example `live_omni`.\n" +
      tables(camera.dump(), sections) + "\n## engram-world\n" + tables(simulator.dump(), sections) +
      "\n## engram-eval\n\nBesides the sections above, some of which have other defaults in an experiment.\n";
  for (const std::string experiment : {"memory", "tours", "words", "views", "odometry"})
    text += tables(runAs<EvalProgram>({experiment, "--dump-config"}).out, sections);
  return text;
}

TEST(KeysPage, IsCurrent) {
  const std::string path = ENGRAM_SOURCE_DIR "/docs/keys.md", now = page();
  if (std::getenv("ENGRAM_UPDATE_DOCS") != nullptr) base::writeText(path, now, true);
  EXPECT_EQ(base::readTextFile(path), now) << "run again with ENGRAM_UPDATE_DOCS=1";
}

}  // namespace
}  // namespace engram::apps
