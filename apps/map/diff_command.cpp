// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "diff_command.h"

#include "engram/apps/program.h"
#include "engram/base/text.h"
#include "engram/keeper/diff.h"
#include "engram/store/map_file.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <ostream>

namespace engram::apps {
namespace {

store::WholeMap wholeOf(const std::string& path) {
  return store::MapFile::open(path, store::Access::kReadOnly).whole();
}

nlohmann::json jsonOf(const keeper::Difference& d) {
  nlohmann::json j = {{"same", d.same()},
                      {"moved_most", d.movedMost},
                      {"moved_mean", d.movedMean},
                      {"parameters", d.parameters}};
  for (const keeper::KindDifference& k : d.kinds)
    j["kinds"][k.kind] = {
        {"equal", k.equal}, {"changed", k.changed}, {"only_a", k.onlyA}, {"only_b", k.onlyB}};
  return j;
}

void printNumbers(std::ostream& out, const char* what, const std::vector<std::uint64_t>& ids) {
  if (ids.empty()) return;
  out << "  " << what << ':';
  for (const std::uint64_t id : ids) out << ' ' << id;
  out << '\n';
}

void printDifference(std::ostream& out, const keeper::Difference& d, bool all) {
  out << "                 equal  changed  only A  only B\n";
  for (const keeper::KindDifference& k : d.kinds) {
    char line[120];
    std::snprintf(line, sizeof line, "%-14s %7zu  %7zu %7zu %7zu\n", k.kind.c_str(), k.equal,
                  k.changed.size(), k.onlyA.size(), k.onlyB.size());
    out << line;
    if (!all) continue;
    printNumbers(out, "changed", k.changed);
    printNumbers(out, "only A", k.onlyA);
    printNumbers(out, "only B", k.onlyB);
  }
  if (d.movedMost > 0)
    out << "places in both moved by " << d.movedMean << " m on average, " << d.movedMost << " m at most\n";
  for (const std::string& line : d.parameters) out << base::forTerminal(line) << '\n';
}

}  // namespace

void DiffCommand::declare(CLI::App& command) {
  command.add_option("a", a_, "Map file")->required();
  command.add_option("b", b_, "Another one")->required();
  command.add_flag("--all", all_, "Print the numbers of all that differs");
  command.add_option("--json", json_, "Also write them to this file");
  command.add_flag("-q,--quiet", quiet_, "Print nothing; the exit code says it");
}

int DiffCommand::run(std::ostream& out) {
  const keeper::Difference d = keeper::diff(wholeOf(a_), wholeOf(b_));
  writeJson(json_, jsonOf(d));
  if (!quiet_ && d.same()) out << "the maps are equal\n";
  if (!quiet_ && !d.same()) printDifference(out, d, all_);
  return d.same() ? kOk : kPartial;
}

}  // namespace engram::apps
