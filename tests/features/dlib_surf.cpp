// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "dlib_surf.h"

#include <dlib/array2d.h>
#include <dlib/image_keypoint.h>

namespace engram::features::test {

types::Features dlibSurf(const cv::Mat& grey, int count) {
  dlib::array2d<unsigned char> image(grey.rows, grey.cols);
  for (int y = 0; y < grey.rows; ++y)
    for (int x = 0; x < grey.cols; ++x) image[y][x] = grey.at<std::uint8_t>(y, x);
  types::Features out;
  out.descriptors = types::Descriptors(types::DescriptorKind::kFloat, 64);
  for (const auto& p : dlib::get_surf_points(image, count, 1.0)) {
    types::Keypoint k;
    k.x = static_cast<float>(p.p.center.x());
    k.y = static_cast<float>(p.p.center.y());
    k.size = static_cast<float>(20 * p.p.scale);
    k.angle = static_cast<float>(p.angle);
    k.response = static_cast<float>(p.p.score);
    k.sign = p.p.laplacian < 0 ? -1 : 1;
    float row[64];
    for (int i = 0; i < 64; ++i) row[i] = static_cast<float>(p.des(i));
    out.keypoints.push_back(k);
    out.descriptors.append(std::as_bytes(std::span(row)));
  }
  return out;
}

}  // namespace engram::features::test
