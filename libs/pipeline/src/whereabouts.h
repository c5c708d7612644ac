// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/map/topological_map.h"
#include "engram/pipeline/dead_reckoning.h"
#include "engram/pipeline/odometry_watch.h"
#include "engram/types/rel_pose.h"

#include <optional>
#include <set>

namespace engram::pipeline {

/// Where the robot is: the place where it was last certain to be, and its way since, by its eyes where they
/// can tell, by its wheels where not.
class Whereabouts {
 public:
  /// @param wheels whether wheel odometry counts. @param frontier the robot begins on new ground
  Whereabouts(const OdometryParams& params, bool wheels, bool frontier)
      : countsWheels_(wheels),
        watch_(params),
        wheels_(params),
        sinceMade_(params),
        sinceMark_(params),
        frontier_(frontier) {}

  /// Move: what the wheels counted up to this image. False when odometry leapt: the way is unknown then.
  bool turn(const std::optional<Eigen::Isometry3d>& T_odom_robot, double stamp);
  /// The wheels stand, the images say that the robot moves: the way since the last image is unknown.
  void wheelsFailed();
  /// Whether either happened since the anchor.
  bool strayed() const { return strayed_; }
  /// How often either happened: odometry is of one piece while this number stays.
  int piece() const { return watch_.health().leaps + watch_.health().frozen; }
  /// Odometry of this image.
  const std::optional<Eigen::Isometry3d>& odometry() const { return T_odom_robot_; }
  OdometryWatch& watch() { return watch_; }
  const OdometryWatch& watch() const { return watch_; }
  /// Move: what visual odometry says, from the anchor. A keyframe is what it goes on from.
  void see(const types::RelPose& T_anchor_robot, double stamp, bool keyframe);
  /// Visual odometry has lost the way, or there is none.
  void lose() { lost_ = true; }
  /// It goes on from the anchor.
  void resume() { lost_ = false; }
  bool lost() const { return lost_; }
  const types::RelPose& anchorToKeyframe() const { return T_anchor_keyframe_; }
  /// As last seen, lost or not, and when [s].
  const types::RelPose& lastSeen() const { return T_anchor_robot_; }
  double seenStamp() const { return seenStamp_; }

  /// Select: an image is taken up. The way since the one before, when the wheels know it.
  std::optional<Travel> markKeyframe();
  /// Of the wheels, since markKeyframe().
  const DeadReckoning& sinceKeyframe() const { return wheels_; }

  /// The place where the robot was last certain to be; invalid at wake-up and after restart().
  base::PlaceId anchor() const { return anchor_; }
  double anchorStamp() const { return anchorStamp_; }
  /// Measured since then; none when nothing measured it.
  std::optional<types::RelPose> motion() const;
  bool metric() const { return motion().has_value(); }
  /// Travelled since then by the wheels [m], up to the last keyframe.
  double sinceAnchor() const { return sinceAnchor_; }
  /// Images taken up since then.
  int imagesSinceAnchor() const { return imagesSinceAnchor_; }

  /// The robot has made a place and is there.
  void made(base::PlaceId place, double stamp, const types::Matrix6d& cov);
  /// It is back at a known place. @param agrees with the way since the last one
  void backAt(base::PlaceId place, const types::RelPose& T_place_robot, bool agrees = true);
  /// An image speaks against where the robot is, and is not believed.
  void doubt() { wheels_.doubt(); }
  /// The anchor is gone from the map.
  void inherit(base::PlaceId heir, const types::RelPose& T_heir_robot);
  /// It is lost: how it got here says nothing.
  void restart();
  /// Places in a row that it was back at and that agree with the way between them.
  int agreeing() const { return agreeing_; }

  /// The robot has just made places and is not known to be back in older ones.
  bool frontier() const { return frontier_; }
  /// Places made in a row, near the newest one, while it goes on.
  const std::set<base::PlaceId>& recent() const { return recent_; }
  /// The place made last is one of them; those farther from it than so many edges are so no more.
  void keepRecent(const map::TopologicalMap& map, int hops);

  /// The place made last in this drive; what the wheels alone say since.
  base::PlaceId lastMade() const { return made_; }
  const DeadReckoning& sinceMade() const { return sinceMade_; }
  /// A place from which the wheels count on, however often the robot is recognised on the way.
  void mark(base::PlaceId place, const types::RelPose& T_place_robot);
  base::PlaceId marked() const { return marked_; }
  const DeadReckoning& sinceMark() const { return sinceMark_; }
  /// The anchor rests on this closure. When the graph denies it, the robot is where its wheels say.
  void restOn(base::EdgeId closure) { anchoredBy_ = closure; }
  void deny(const std::vector<base::EdgeId>& closures);

 private:
  void stray();

  bool countsWheels_, strayed_ = false;
  OdometryWatch watch_;
  std::optional<Eigen::Isometry3d> T_odom_robot_;  // of this image
  DeadReckoning wheels_;                           // from the anchor
  DeadReckoning sinceMade_;                        // from the place made last: wheels alone
  DeadReckoning sinceMark_;                        // from the marked place: wheels alone
  bool frontier_;
  bool restarted_ = false;  // since the last keyframe
  base::PlaceId anchor_, made_, marked_;
  base::EdgeId anchoredBy_;  // invalid when the anchor rests on no closure
  std::set<base::PlaceId> recent_;
  double anchorStamp_ = 0, sinceAnchor_ = 0;
  int agreeing_ = 0, imagesSinceAnchor_ = 0;

  bool lost_ = true;
  types::RelPose T_anchor_keyframe_, T_anchor_robot_;  // by the eyes
  double seenStamp_ = 0;
};

}  // namespace engram::pipeline
