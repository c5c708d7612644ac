// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/image_folder_source.h"

#include <memory>
#include <string>
#include <vector>

namespace engram::sources {

/// The image files that `images` means: those of a folder, or of a folder and a pattern with * and ?, such as
/// `cam/*_0.jpg`. Paths, sorted naturally. Throws base::Error when there are none.
std::vector<std::string> findImages(const std::string& images);

/// Unix time [s] in a file name: a number of 10 (seconds, with fraction), 13, 16 or 19 digits (milli-,
/// micro-, nanoseconds). Throws base::Error when there is none.
double stampInName(const std::string& name);

/// Images of one camera, or pairs of a stereo camera, as frames.
///
/// @param left,right as for findImages(); `right` may be empty. A left and a right image belong together when
///   the longest numbers in their names are equal. Images without a partner are left out and named in
///   problem().
/// @param stamps empty: one second apart; `names`: stampInName(); else a file with one stamp [`unit`] a line
/// for
///   each left image, in natural order.
/// Throws base::Error when no image has a partner, when names do not tell which belong together, or for a
/// file of stamps that does not fit.
std::unique_ptr<ImageListSource> openImagePairs(const std::string& left, const std::string& right,
                                                const std::string& stamps, StampUnit unit = StampUnit::kAuto);

}  // namespace engram::sources
