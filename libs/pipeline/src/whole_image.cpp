// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/whole_image.h"

#include "engram/map/picture.h"

#include <opencv2/imgcodecs.hpp>

#include <cstring>
#include <optional>
#include <span>

namespace engram::pipeline {

namespace {

/// Row beside the map: version, describer, components.
constexpr std::uint8_t kSignatureVersion = 1;

std::vector<std::uint8_t> encodeSignature(std::uint32_t describer, const Eigen::VectorXf& signature) {
  const auto size = static_cast<std::size_t>(signature.size()) * sizeof(float);
  std::vector<std::uint8_t> row(1 + sizeof describer + size);
  row[0] = kSignatureVersion;
  std::memcpy(row.data() + 1, &describer, sizeof describer);
  std::memcpy(row.data() + 1 + sizeof describer, signature.data(), size);
  return row;
}

/// None of another describer.
std::optional<Eigen::VectorXf> decodeSignature(std::span<const std::uint8_t> row, std::uint32_t describer,
                                               Eigen::Index dim) {
  Eigen::VectorXf signature(dim);
  const auto size = static_cast<std::size_t>(dim) * sizeof(float);
  if (row.size() != 1 + sizeof describer + size || row[0] != kSignatureVersion ||
      std::memcmp(row.data() + 1, &describer, sizeof describer) != 0)
    return std::nullopt;
  std::memcpy(signature.data(), row.data() + 1 + sizeof describer, size);
  if (!signature.allFinite()) return std::nullopt;
  return signature;
}

}  // namespace

void WholeImage::restore(const map::TopologicalMap& map) {
  index_.reserve(map.places().size());
  if (const auto& kept = map.content().derived)
    kept->read(map::DerivedKind::kSignature, [&](std::uint32_t id, std::span<const std::uint8_t> row) {
      if (auto signature = decodeSignature(row, describer_->name(), describer_->dim()))
        restored_.emplace(id, std::move(*signature));
    });
}

std::vector<map::DerivedRow> WholeImage::changes() {
  std::vector<map::DerivedRow> rows;
  for (const auto& [view, place] : unkept_)
    rows.push_back({map::DerivedKind::kSignature, view.value,
                    encodeSignature(describer_->name(), index_.signature(place))});
  unkept_.clear();
  return rows;
}

void WholeImage::add(const map::TopologicalMap& map, base::PlaceId place, std::size_t index) {
  Eigen::VectorXf signature = Eigen::VectorXf::Zero(describer_->dim());
  for (const base::ViewId id : map.viewsOf(place)) {
    if (const auto known = restored_.find(id); known != restored_.end()) {
      signature = known->second;
      break;
    }
    const auto& jpeg = map.views().at(id).jpeg;
    if (jpeg.empty() || !map::brokenPicture(jpeg).empty()) continue;
    const cv::Mat picture = cv::imdecode(jpeg, cv::IMREAD_GRAYSCALE);
    if (picture.empty()) continue;
    signature = describer_->describe(picture);
    unkept_[id] = index;
    break;
  }
  index_.set(index, signature);
}

std::vector<double> WholeImage::similarities(const cv::Mat& picture) const {
  return index_.similarities(describer_->describeQuery(picture));
}

}  // namespace engram::pipeline
