// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "copy_command.h"

#include "engram/apps/program.h"
#include "engram/store/map_copy.h"

#include <ostream>

namespace engram::apps {

void printMissingLog(const std::string& map, std::ostream& err) {
  const std::string missing = store::missingLog(map);
  if (!missing.empty()) err << "engram-map: warning: map '" << map << "': " << missing << '\n';
}

void CopyCommand::declare(CLI::App& command) {
  command.add_option("from", from_, "Map file; it is not changed")->required();
  command.add_option("to", to_, "Map file to make")->required();
  command.add_flag("--overwrite", overwrite_, "Replace the map 'to' if it exists");
  command.add_flag("-q,--quiet", quiet_, "Print warnings, losses and errors only");
}

int CopyCommand::run(std::ostream& out, std::ostream& err) {
  if (kind_ == Kind::kRecover) return recover(out);
  printMissingLog(from_, err);
  store::copyMap(from_, to_, overwrite_);
  if (!quiet_) out << to_ << ": written\n";
  return kOk;
}

int CopyCommand::recover(std::ostream& out) {
  const store::Recovery r = store::recoverMap(from_, to_, overwrite_);
  if (!quiet_)
    out << to_ << ": " << r.places << " places, " << r.views << " views, " << r.edges << " edges, " << r.path
        << " path points, records of " << r.records << " images\n";
  for (const std::string& lost : r.lost) out << "lost: " << lost << '\n';
  if (r.lost.empty() && !quiet_) out << from_ << ": all of it was saved\n";
  return r.lost.empty() ? kOk : kPartial;
}

}  // namespace engram::apps
