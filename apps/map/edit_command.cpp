// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "edit_command.h"

#include "engram/apps/program.h"
#include "engram/base/text.h"
#include "engram/store/map_copy.h"
#include "engram/store/map_file.h"

#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

void EditCommand::declare(CLI::App& command) {
  command.add_option("map", map_, "Map to change")->required();
  command.add_flag("--dry-run", dryRun_, "Say what would be done; no byte changes");
  command
      .add_option("--undo", undo_,
                  "File for the map as it was (default: the map's name with .undo, .undo-2, …)")
      ->excludes("--dry-run");
  command.add_flag("-q,--quiet", quiet_, "Print errors only");
}

std::string EditCommand::undoPathOf(const std::string& map) {
  const auto name = map.find("map=");
  const bool onServer = map.find("://") != std::string::npos && name != std::string::npos;
  const std::string file = onServer ? map.substr(name + 4, map.find('&', name) - name - 4) + ".engram" : map;
  const std::string stem = file + ".undo";
  std::string path = stem;
  for (int i = 2; fs::exists(path); ++i) path = stem + "-" + std::to_string(i);
  return path;
}

int EditCommand::run(std::ostream& out, std::ostream& err,
                     const std::function<bool(store::WholeMap&, std::ostream&)>& change) const {
  std::ostream silent(nullptr);
  std::ostream& report = quiet_ ? silent : out;
  auto file = store::MapFile::open(map_, dryRun_ ? store::Access::kReadOnly : store::Access::kReadWrite);
  store::WholeMap whole = file.whole();
  const bool cutOff = !whole.drives.empty() && !whole.drives.back().finished;
  if (!change(whole, report)) {
    report << "nothing to do\n";
    return kOk;
  }
  if (dryRun_) {
    report << "dry run: the map was not changed\n";
    return kOk;
  }
  const std::string undo = undo_.empty() ? undoPathOf(map_) : undo_;
  store::copyMap(map_, undo);
  file.replace(whole);
  file.close();
  report << base::forTerminal(map_) << ": written; as it was: " << base::forTerminal(undo)
         << " (back with engram-map copy UNDO MAP --overwrite)\n";
  if (cutOff)
    err << "engram-map: its last drive was cut off and cannot be resumed any more; it can in the undo copy\n";
  return kOk;
}

}  // namespace engram::apps
