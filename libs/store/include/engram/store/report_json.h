// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/frame_report.h"

#include <string>

namespace engram::store {

/// A FrameReport as one line of JSON, without line break. Keys, in this order:
///
///     index, stamp [s], label, outcome (skipped|unusable|new_place|recognised|refused), reason, features,
///     place, best_guess (null when invalid), best_guess_interpolated, new_place_probability,
///     accepted_by (geometry|sequence) where a place was accepted, rival where another explains it as well,
///     pose {x, y [m], heading [rad] in the map, sigma_along, sigma_across, sigma_heading} where it is known,
///     hypotheses [{place, similarity, posterior, inliers}], closure,
///     memory {rehearsed, added, pruned, promoted, demoted, long_term, short_term},
///     times {step: ms, …}, ms, and of live work: live {latency_ms, waiting, incomplete, missed, dropped}
///
/// Probabilities, similarities and times have six decimals. Numbers that are not finite become null. Bytes
/// that are not UTF-8 become U+FFFD.
/// @param withTimes false leaves out `times`, `ms` and `live`, the only values that differ between equal
/// runs.
std::string toJson(const types::FrameReport& report, bool withTimes = true);

/// The reverse. Missing keys keep their defaults, unknown ones are skipped, null numbers are NaN.
/// Throws base::Error when the line is not such an object.
types::FrameReport reportFromJson(const std::string& line);

}  // namespace engram::store
