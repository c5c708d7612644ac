// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/held_records.h"

namespace engram::apps {
namespace {

constexpr std::size_t kMost = 4096;

}  // namespace

bool HeldRecords::due(const types::FrameReport& report) {
  using types::Outcome;
  if (!firstStamp_) firstStamp_ = report.stamp;
  held_.push_back(report);
  useful_ = useful_ || (report.outcome != Outcome::kUnusable && report.outcome != Outcome::kSkipped) ||
            held_.size() >= kMost;
  return useful_;
}

void HeldRecords::commitTo(store::MapFile& file, map::TopologicalMap& map) {
  for (const auto& report : held_) file.commit(map, map.takeChanges(), &report);
  held_.clear();
}

}  // namespace engram::apps
