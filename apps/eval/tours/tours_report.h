// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "tours/room_lab.h"
#include "tours/tours_figures.h"

#include <cstdint>
#include <string>
#include <vector>

namespace engram::apps {

/// The page of engram-eval tours: the figures 5 and 8 of Dayoub & Duckett 2008 from our data, failures over
/// the tours, the room that was changed by hand, and the tables beside the paper's figures.
std::string toHtml(const std::vector<ToursFigure>& figures, const std::vector<ToursRun>& runs,
                   const std::vector<RoomResult>& room, const ToursParams& params,
                   const std::string& settings, std::uint64_t seed);

}  // namespace engram::apps
