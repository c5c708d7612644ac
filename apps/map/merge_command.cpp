// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "merge_command.h"

#include "edit_command.h"
#include "engram/apps/program.h"
#include "engram/base/progress.h"
#include "engram/keeper/merge.h"
#include "engram/store/map_copy.h"

#include <nlohmann/json.hpp>

#include <ostream>

namespace engram::apps {
namespace {

nlohmann::json mergeFigures(const keeper::Merged& m, std::size_t places) {
  return {{"joined", m.joined},     {"reason", m.reason}, {"verified", m.verified}, {"agreeing", m.agreeing},
          {"closures", m.closures}, {"united", m.united}, {"known", m.known},       {"places", places}};
}

void printMerge(std::ostream& out, const keeper::Merged& m, std::size_t places) {
  out << m.verified << " places recognised, " << m.agreeing << " agree, " << m.closures << " joints, "
      << m.united << " places united";
  if (m.known > 0) out << ", " << m.known << " known to both before";
  out << "; " << places << " places\n";
  if (!m.reason.empty()) out << m.reason << '\n';
}

}  // namespace

void MergeCommand::declare(CLI::App& command) {
  command.add_option("a", a_, "Map file: its frame and numbers stay")->required();
  command.add_option("b", b_, "Map of the same building")->required();
  auto* target = command.add_option("--out", out_, "Map file to make");
  command.add_flag("--into", into_, "Change A: it becomes both; as it was it is copied to A.undo")
      ->excludes(target);
  command.add_flag("--dry-run", dryRun_, "Say what would be joined; write nothing")->excludes(target);
  command.add_flag("--overwrite", overwrite_, "Replace the map --out if it exists");
  command.add_option("--json", json_, "Also write the figures to this file");
  command.add_flag("-q,--quiet", quiet_, "Print errors only");
}

int MergeCommand::run(std::ostream& out, std::ostream& err) {
  if (out_.empty() && !into_ && !dryRun_) throw UsageError("merge needs --out FILE, --into, or --dry-run");
  if (!out_.empty() && store::MapFile::exists(out_) && !overwrite_)
    throw base::Error("map '" + out_ + "' exists already: give --overwrite to replace it");
  const bool changes = into_ && !dryRun_;
  auto file = store::MapFile::open(a_, changes ? store::Access::kReadWrite : store::Access::kReadOnly);
  store::WholeMap a = file.whole();
  const store::WholeMap b = store::MapFile::open(b_, store::Access::kReadOnly).whole();
  base::Progress progress(quiet_ ? nullptr : &err, "recognising");
  std::size_t done = 0;
  const keeper::Merged merged =
      keeper::merge(a, b, a_, b_, [&](double share) { progress.update(share, ++done); });
  progress.finish();
  writeJson(json_, mergeFigures(merged, a.content.places.size()));
  if (!quiet_) printMerge(out, merged, a.content.places.size());
  if (!merged.joined) {
    err << "engram-map: '" << a_ << "' and '" << b_ << "' were kept apart: " << merged.reason << '\n';
    return kError;
  }
  if (dryRun_) return kOk;
  const std::string written = write(file, a);
  if (!quiet_) out << written << '\n';
  return kOk;
}

std::string MergeCommand::write(store::MapFile& file, const store::WholeMap& merged) const {
  if (into_) {
    const std::string undo = EditCommand::undoPathOf(a_);
    store::copyMap(a_, undo);
    file.replace(merged);
    file.close();
    return a_ + ": written; as it was: " + undo;
  }
  auto made = store::MapFile::create(out_, merged.header, overwrite_);
  made.replace(merged);
  made.close();
  return out_ + ": written";
}

}  // namespace engram::apps
