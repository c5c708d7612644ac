// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "index_command.h"

#include "engram/apps/program.h"
#include "engram/base/config.h"
#include "engram/base/held_text.h"
#include "engram/base/text.h"
#include "engram/pipeline/pipeline.h"
#include "engram/store/map_file.h"

#include <ostream>

namespace engram::apps {

void IndexCommand::declare(CLI::App& command) {
  command.add_option("map", map_, "Map file")->required();
  command.add_flag("-q,--quiet", quiet_, "Print errors only");
}

/// By the configuration that the map was made with: that of a program which opens it.
int IndexCommand::run(std::ostream& out) const {
  store::MapFile file = store::MapFile::open(map_, store::Access::kReadWrite);
  const map::MapHeader& header = file.header();
  pipeline::PipelineParams params;
  base::Config config;
  params.bind(config);
  base::IniFile ini = base::IniFile::parse(header.parameters, "configuration of map '" + map_ + "'");
  ini.take("source");  // of the images that it was made of
  config.read(ini);
  const base::HeldText camera(header.camera);
  if (header.camera.starts_with("[")) params.camera.file = camera.path();
  pipeline::Pipeline opened(params, file.loadOnDemand(), pipeline::Use::kFrozen);
  store::requireCompatible(header, opened.header(), map_);
  const auto rows = opened.derived();
  file.keep(rows);
  file.close();
  if (!quiet_)
    out << base::forTerminal(map_) << ": " << rows.size()
        << " rows of the index made, the others were there\n";
  return kOk;
}

}  // namespace engram::apps
