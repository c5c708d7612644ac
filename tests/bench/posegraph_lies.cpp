// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A table: graphs with false closures, gated and relaxed, against the same graphs without any.
#include "../posegraph/big_graphs.h"
#include "engram/posegraph/robust.h"

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

namespace engram::posegraph {
namespace {

struct Outcome {
  double ate = 0, seconds = 0;
  std::size_t trueIn = 0, falseIn = 0;
};

Outcome solve(const Drive& drive) {
  const std::clock_t start = std::clock();
  const RobustRelaxation r = relaxRobustly({}, drive.trusted, drive.closures);
  Outcome out;
  out.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;  // of the processor
  out.ate = ate(drive.truth, r.relaxation.poses);
  for (std::size_t i = 0; i < drive.closures.size(); ++i)
    if (r.decisions[i].accepted) ++(drive.isTrue[i] ? out.trueIn : out.falseIn);
  return out;
}

/// All closures, the kernel alone.
double ungated(const Drive& drive) {
  Graph graph = drive.trusted;
  graph.constraints.insert(graph.constraints.end(), drive.closures.begin(), drive.closures.end());
  return ate(drive.truth, makeRelaxer({})->relax(graph).poses);
}

void table(const char* name, const Drive& clean, bool alone) {
  const Outcome reference = solve(clean);
  std::printf("%s: %zu places, %zu true closures; ATE of odometry %.2f m\n", name, clean.truth.size(),
              clean.closures.size(), ate(clean.truth, clean.trusted.poses));
  std::printf("  %-18s %8s %7s %10s %11s %8s %9s\n", "lies", "ATE m", "ratio", "true in", "false in", "s",
              "no gate m");
  std::printf("  %-18s %8.4f %7s %10zu %11s %8.1f %9.3f\n", "none", reference.ate, "", reference.trueIn, "",
              reference.seconds, alone ? ungated(clean) : NAN);
  for (const bool clustered : {false, true})
    for (const double share : {0.01, 0.1, 0.5}) {
      Drive drive = clean;
      addLies(drive, share, clustered, 99);
      const Outcome o = solve(drive);
      const std::size_t lies = drive.closures.size() - clean.closures.size();
      std::printf("  %3.0f %% %-12s %8.4f %7.2f %10zu %5zu/%5zu %8.1f %9.3f\n", 100 * share,
                  clustered ? "clustered" : "random", o.ate, o.ate / reference.ate, o.trueIn, o.falseIn, lies,
                  o.seconds, alone ? ungated(drive) : NAN);
      std::fflush(stdout);
    }
}

}  // namespace
}  // namespace engram::posegraph

int main(int argc, char** argv) {
  using namespace engram::posegraph;
  bool alone = false;
  std::string only;
  int tables = 0;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const int n = std::atoi(argv[i]);
    if (word == "--kernel-alone") {
      alone = true;
    } else if (n < 200) {
      only = word;
    } else {
      const auto places = static_cast<std::uint32_t>(n);
      if (only.empty() || only == "streets") table("streets", manhattan(places, 1), alone);
      if (only.empty() || only == "corridor") table("corridor", corridor(places, 2), alone);
      if (only.empty() || only == "buildings") table("buildings", buildings(places, 3), alone);
      ++tables;
    }
  }
  if (tables == 0)
    std::fprintf(stderr, "usage: posegraph_lies [--kernel-alone] [streets|corridor|buildings] PLACES...\n");
  return tables == 0 ? 2 : 0;
}
