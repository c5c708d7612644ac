// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/frame_source.h"

#include <memory>
#include <string>

namespace engram::sources {

/// The images of a video, of any kind that OpenCV reads. Stamps [s] are those of the video, from its
/// beginning; a label is the file name and the number of the image, from 0: `walk.mp4#17`. A video that ends
/// early is named in problem(). Throws base::Error for a file that is missing or no video.
std::unique_ptr<FrameSource> openVideo(const std::string& path);

}  // namespace engram::sources
