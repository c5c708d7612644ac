// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/types/features.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace engram::types {

std::size_t Descriptors::rowBytes() const {
  const auto dim = static_cast<std::size_t>(dim_);
  switch (kind_) {
    case DescriptorKind::kFloat:
      return dim * sizeof(float);
    case DescriptorKind::kInt8:
      return dim;
    case DescriptorKind::kBinary:
      return (dim + 63) / 64 * 8;
  }
  return 0;
}

const float* Descriptors::floats(std::size_t i) const {
  return reinterpret_cast<const float*>(row(i).data());
}

const std::int8_t* Descriptors::int8(std::size_t i) const {
  return reinterpret_cast<const std::int8_t*>(row(i).data());
}

const std::uint64_t* Descriptors::words(std::size_t i) const {
  return reinterpret_cast<const std::uint64_t*>(row(i).data());
}

Descriptors quantised(const Descriptors& descriptors) {
  if (descriptors.kind() != DescriptorKind::kFloat) return descriptors;
  Descriptors out(DescriptorKind::kInt8, descriptors.dim());
  out.resize(descriptors.size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const float* from = descriptors.floats(i);
    auto* to = reinterpret_cast<std::int8_t*>(out.mutableRow(i));
    for (int d = 0; d < descriptors.dim(); ++d)
      to[d] = static_cast<std::int8_t>(std::lround(std::clamp(from[d] * kInt8Scale, -127.0f, 127.0f)));
  }
  return out;
}

Features Features::subset(std::span<const int> indices) const {
  Features out;
  out.descriptors = Descriptors(descriptors.kind(), descriptors.dim());
  out.keypoints.reserve(indices.size());
  out.descriptors.reserve(indices.size());
  for (const int i : indices) out.append(*this, static_cast<std::size_t>(i));
  return out;
}

void Features::append(const Features& other, std::size_t i) {
  if (descriptors.dim() == 0) descriptors = Descriptors(other.descriptors.kind(), other.descriptors.dim());
  if (!descriptors.sameLayout(other.descriptors))
    throw std::invalid_argument("Features::append: descriptors of another kind");
  keypoints.push_back(other.keypoints[i]);
  descriptors.append(other.descriptors.row(i));
  if (!other.bearings.empty()) bearings.push_back(other.bearings[i]);
  if (ranges.empty() && other.ranges.empty()) return;
  ranges.resize(keypoints.size());
  if (!other.ranges.empty()) ranges.back() = other.ranges[i];
}

}  // namespace engram::types
