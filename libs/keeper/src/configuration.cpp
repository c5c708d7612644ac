// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/keeper/configuration.h"

namespace engram::keeper {

Configuration configurationOf(const map::MapHeader& header, const std::string& name) {
  Configuration result;
  base::IniFile ini = base::IniFile::parse(header.parameters, "configuration of map '" + name + "'");
  ini.take("source");  // of the images, which are not here
  base::Config config;
  result.params.bind(config);
  config.read(ini);
  if (!header.camera.starts_with("[")) return result;
  result.camera = std::make_shared<base::HeldText>(header.camera);
  result.params.camera.file = result.camera->path();
  return result;
}

}  // namespace engram::keeper
