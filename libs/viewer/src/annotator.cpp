// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "annotator.h"

#include "engram/pipeline/place_match.h"

namespace engram::viewer {

std::vector<Mark> Annotator::marks(const Snapshot& snapshot) {
  if (!perception_.refusal(snapshot.image).empty()) return {};
  const types::Features features = perception_(snapshot.image);
  const double scale =
      params_.camera.image_width > 0 ? 1.0 * snapshot.image.cols / params_.camera.image_width : 1.0;
  std::vector<Mark> marks;
  for (const auto& k : features.keypoints)
    marks.push_back({{static_cast<float>(scale * k.x), static_cast<float>(scale * k.y)},
                     static_cast<float>(scale * k.size)});
  if (!snapshot.memory) return marks;
  const auto match = pipeline::matchToPlace(features, *snapshot.memory, params_.match, params_.verify);
  for (const auto& m : match.matches) {
    const auto stage = snapshot.memory->states[static_cast<std::size_t>(m.b)].stage;
    marks[static_cast<std::size_t>(m.a)].kind =
        stage == memory::Stage::kLongTerm ? Mark::Kind::kLongTerm : Mark::Kind::kShortTerm;
  }
  return marks;
}

}  // namespace engram::viewer
