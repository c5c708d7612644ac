// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"

#include <opencv2/core/mat.hpp>

#include <span>
#include <vector>

namespace engram::features {

/// All indices, by falling response; ties by position, size and angle, so that the order never depends on
/// threads.
std::vector<int> strongestFirst(std::span<const types::Keypoint> keypoints);

/// Indices of the keypoints whose circle of `margin` times the radius lies where `mask` is not 0. The circle
/// is probed at its centre and on two rings; points outside the image count as inside. An empty mask admits
/// all.
std::vector<int> insideMask(std::span<const types::Keypoint> keypoints, const cv::Mat& mask, double margin);

/// At most `count` of `candidates`. With `gridCells` > 0 each of gridCells² cells first gets its equal share;
/// what is left over goes to the strongest of the rest. In order of falling response.
std::vector<int> strongest(std::span<const types::Keypoint> keypoints, std::vector<int> candidates,
                           cv::Size imageSize, int count, int gridCells);

}  // namespace engram::features
