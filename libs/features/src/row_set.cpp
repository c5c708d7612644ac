// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/features/row_set.h"

#include "nearest.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace engram::features {
namespace {

/// Without signs all are in the first group, in their order.
PreparedSet prepared(const types::Descriptors& descriptors) {
  types::Features features;
  features.descriptors = types::quantised(descriptors);
  features.keypoints.resize(features.descriptors.size());
  return PreparedSet(features);
}

}  // namespace

struct RowSet::State {
  PreparedSet set;
  const DescriptorGroup& rows() const { return set.groups[0]; }
};

RowSet::RowSet(const types::Descriptors& descriptors)
    : state_(std::make_unique<State>(State{prepared(descriptors)})) {}
RowSet::~RowSet() = default;
RowSet::RowSet(RowSet&&) noexcept = default;
RowSet& RowSet::operator=(RowSet&&) noexcept = default;

std::size_t RowSet::size() const { return state_->set.size; }

void RowSet::nearest(const RowSet& queries, std::size_t begin, std::span<int> out) const {
  const PreparedSet &asked = queries.state_->set, &mine = state_->set;
  if (out.empty()) return;
  if (begin + out.size() > asked.size) throw std::invalid_argument("RowSet::nearest: no such queries");
  if (mine.size > 0 && (asked.kind != mine.kind || asked.dim != mine.dim))
    throw std::invalid_argument("RowSet::nearest: descriptors of another kind or dimension");
  std::vector<Nearest> found(out.size());
  findNearest(supportedSimd(), mine.kind, queries.state_->rows(), static_cast<int>(begin),
              static_cast<int>(begin + out.size()), state_->rows(), found.data());
  std::transform(found.begin(), found.end(), out.begin(), [](const Nearest& n) { return n.row; });
}

}  // namespace engram::features
