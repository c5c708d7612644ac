// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/evaluation/place_truth.h"
#include "engram/evaluation/trajectory.h"
#include "engram/evaluation/truth.h"
#include "engram/evaluation/truth_match.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/pipeline.h"
#include "engram/types/frame_report.h"

#include <nlohmann/json_fwd.hpp>

#include <iosfwd>
#include <optional>
#include <string>
#include <vector>

namespace engram::apps {

/// A verdict on one answer.
struct Judgement {
  evaluation::Verdict verdict = evaluation::Verdict::kUnknown;
  std::optional<double> error;  ///< [places], with TUM truth
};

/// How far a pose is from the true one, in the plane.
struct PoseError {
  double position = 0;  ///< [m]
  double heading = 0;   ///< [rad], not negative
  double nees = 0;      ///< squared error in units of the reported covariance, by its 3 degrees of freedom
};

/// Ground truth held against a map. Only programs use it: nothing that maps or localises sees it.
class MapTruth {
 public:
  MapTruth(const std::string& path, const evaluation::TruthOptions& options);

  bool hasPoses() const { return truth_.kind() == evaluation::TruthKind::kPoses; }
  const evaluation::Trajectory& poses() const { return poses_; }

  /// Takes note of an image of the run, for requireMatch().
  void note(const types::FrameReport& report);
  /// The same, and keeps the true pose of a place that the image of this report made, for later evaluation.
  void survey(pipeline::Pipeline& mapper, const types::FrameReport& report);

  /// At the end of a whole run: throws base::Error when the truth cannot be that of its images; says to
  /// `notices` what was taken for granted.
  void requireMatch(const map::TopologicalMap& map, std::ostream& notices) const;

  /// Is a loop closure from this image to this place real?
  evaluation::Verdict judgeClosure(const map::TopologicalMap& map, const types::FrameReport& report,
                                   base::PlaceId place) const;

  /// To be called before judge(). Throws base::Error for poses when the map's places were not surveyed.
  void readPlaces(const map::TopologicalMap& map);
  /// Is it right that the image of this report shows this place?
  /// @param peak interpolated position along the chain of places; negative to take the place itself.
  Judgement judge(const map::TopologicalMap& map, const types::FrameReport& report, base::PlaceId place,
                  double peak) const;
  bool answerable(const types::FrameReport& report) const;
  /// Of the pose in the report, by the surveyed pose of the place that it hangs on; none without either.
  std::optional<PoseError> poseError(const map::TopologicalMap& map, const types::FrameReport& report) const;

 private:
  evaluation::Truth truth_;
  evaluation::TruthMatch match_;
  evaluation::Trajectory poses_;
  evaluation::SurveyedPlaces surveyed_;
  std::vector<base::PlaceId> ids_;
};

/// Error of the path of one drive.
struct PathError {
  double ate = 0;    ///< absolute trajectory error after alignment in the plane, rms [m]
  double apart = 0;  ///< share of the path left out: it lies in other parts of the map (K-E14)
};

/// None without truth at the stamps of the drive.
std::optional<PathError> trajectoryError(const map::TopologicalMap& map, int session,
                                         const evaluation::Trajectory& truth);

}  // namespace engram::apps
