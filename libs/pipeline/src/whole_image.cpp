// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/pipeline/whole_image.h"

#include "engram/map/picture.h"

#include <opencv2/imgcodecs.hpp>

namespace engram::pipeline {

void WholeImage::add(const map::TopologicalMap& map, base::PlaceId place, std::size_t index) {
  Eigen::VectorXf signature = Eigen::VectorXf::Zero(describer_->dim());
  for (const base::ViewId id : map.viewsOf(place)) {
    const auto& jpeg = map.views().at(id).jpeg;
    if (jpeg.empty() || !map::brokenPicture(jpeg).empty()) continue;
    const cv::Mat picture = cv::imdecode(jpeg, cv::IMREAD_GRAYSCALE);
    if (picture.empty()) continue;
    signature = describer_->describe(picture);
    break;
  }
  index_.set(index, signature);
}

std::vector<double> WholeImage::similarities(const cv::Mat& picture) const {
  return index_.similarities(describer_->describeQuery(picture));
}

}  // namespace engram::pipeline
