// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/config_file.h"

#include "engram/base/error.h"
#include "engram/base/text.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <sstream>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

constexpr const char* kEnding = ".ini";

bool isFile(const fs::path& path) {
  std::error_code status;
  return fs::exists(path, status) && !fs::is_directory(path, status);
}

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::vector<std::string> configFolders() {
  std::vector<std::string> folders;
  const std::string xdg = variable("XDG_CONFIG_HOME"), home = variable("HOME");
  if (!xdg.empty())
    folders.push_back(xdg + "/engram");
  else if (!home.empty())
    folders.push_back(home + "/.config/engram");
  std::error_code status;
  const fs::path program = fs::read_symlink("/proc/self/exe", status);
  if (!status) folders.push_back((program.parent_path().parent_path() / "share/engram").string());
  const std::string shares = variable("XDG_DATA_DIRS");
  std::istringstream in(shares.empty() ? "/usr/local/share:/usr/share" : shares);
  for (std::string share; std::getline(in, share, ':');)
    if (!share.empty()) folders.push_back(share + "/engram");
  return folders;
}

std::vector<std::string> configNames() {
  std::set<std::string> names;
  for (const auto& folder : configFolders()) {
    std::error_code status;
    for (const auto& entry : fs::directory_iterator(folder, status))
      if (entry.path().extension() == kEnding) names.insert(entry.path().stem().string());
  }
  return {names.begin(), names.end()};
}

std::string findConfig(const std::string& given) {
  if (isFile(given)) return given;
  const bool isName = given.find('/') == std::string::npos;
  if (isName)
    for (const auto& folder : configFolders())
      for (const std::string& ending : {std::string(), std::string(kEnding)})
        if (const auto file = fs::path(folder) / (given + ending); isFile(file)) return file.string();
  std::error_code status;
  const bool isFolder = fs::is_directory(given, status);
  std::string known;
  for (const auto& name : configNames()) known += (known.empty() ? "; by name there are " : ", ") + name;
  throw base::ConfigError(base::printable(given) +
                          (isFolder ? ": is a folder, not a configuration" : ": no such configuration") +
                          known);
}

base::IniFile loadConfig(const std::string& given) { return base::IniFile::load(findConfig(given)); }

}  // namespace engram::apps
