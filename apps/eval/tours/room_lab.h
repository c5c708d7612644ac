// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/contender.h"
#include "common/table.h"
#include "common/workplace.h"
#include "engram/base/params.h"
#include "engram/evaluation/bootstrap.h"
#include "engram/world/world.h"

#include <string>
#include <vector>

namespace engram::apps {

/// Section `[room]`: the first experiment of D (D-09). The paper tells the number of images and the reach;
/// how much is changed by hand is ours.
struct RoomParams {
  int images = 251;               ///< the first one is the reference view
  double reach = 1.0;             ///< [m] to both sides of it, back and forth
  int period = 20;                ///< images of one way back and forth
  double poster_share = 0.03;     ///< of the posters changed before each image
  double furniture_share = 0.03;  ///< of the furniture moved before each image
  int rearranged_every = 50;      ///< images from one large change to the next
  double rearranged_share = 0.4;  ///< of posters and furniture that it changes

  void describe(base::Params& p);
};

/// How one memory did.
struct RoomResult {
  std::string method;
  std::vector<int>
      matched;  ///< points of each image but the first, with the long-term memory before it learns
  std::vector<int> longTerm, shortTerm;  ///< features after each of these images
  int learnt = 0;                        ///< images that geometry confirmed
  evaluation::Interval mean;             ///< of `matched`; 95 %, stretches between large changes as blocks
  double sigma = 0;                      ///< standard deviation of `matched`
};

/// Where the robot is at image i: on the route about `arc`, in its direction. The first is in the middle.
world::Pose2 roomPose(const world::Route& route, double arc, const RoomParams& params, int i);

/// Every method in the same images. @param views the first makes the place
std::vector<RoomResult> roomResults(const std::vector<types::Features>& views,
                                    const std::vector<Method>& methods, const RoomParams& params,
                                    int threads);

/// D-09: in the most spacious room on the tour of the preset. The features stay in `room` of the folder.
/// Throws base::Interrupted.
std::vector<RoomResult> room(const RoomParams& params, const std::string& preset,
                             const pipeline::PipelineParams& pipeline, const Workplace& place);

ResultTable tableOf(const std::vector<RoomResult>& results);
/// The table beside the paper's figures.
std::string toText(const std::vector<RoomResult>& results);

}  // namespace engram::apps
