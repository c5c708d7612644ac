// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/cameras/stereo_rig.h"
#include "engram/sources/frame_source.h"

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace engram::sources {

/// Section [source].
struct RawlogParams {
  std::string sensor_label;
  std::string right_label;
  double pair_tolerance = 0.001;  // [s]
  std::string odometry = "auto";
  std::string odometry_label;
  std::string images_dir;
  int look_ahead = 32;
  double odometry_hold = 1.0;  // [s]

  void describe(base::Params& p) {
    p.add("sensor_label", sensor_label, "label of the camera to use; empty: the first camera of the rawlog");
    p.add(
        "right_label", right_label,
        "label of the right camera where both eyes of a stereo camera are recorded as cameras of their own; "
        "sensor_label is the left one");
    p.add("pair_tolerance", pair_tolerance, "right_label: largest difference of the stamps of a pair [s]",
          {0, 10});
    p.addChoice(
        "odometry", odometry,
        "kind of odometry to use: auto is the first kind found, observation CObservationOdometry, action "
        "CActionRobotMovement2D",
        {"auto", "observation", "action", "none"});
    p.add("odometry_label", odometry_label, "label of the odometry to use; empty: the first one found");
    p.add("images_dir", images_dir,
          "folder of images stored outside; empty: <rawlog name>_Images beside the rawlog");
    p.add("look_ahead", look_ahead, "images kept back at most while waiting for odometry beyond their stamp",
          {1, 1000});
    p.add("odometry_hold", odometry_hold,
          "time that the first and last odometry sample stand for earlier and later images [s]", {0, 3600});
  }
};

/// What a rawlog held and what was left out, so far.
struct RawlogStats {
  std::map<std::string, std::map<std::string, std::size_t>> objects;  ///< class -> label -> how many
  std::map<std::string, std::size_t> cameras;                         ///< label -> images
  std::size_t images = 0;                                             ///< delivered
  std::size_t imagesDamaged = 0;                                      ///< could not be decoded
  std::size_t imagesMissing = 0;                                      ///< stored outside, file not found
  std::size_t imagesBadStamp = 0;    ///< left out: the stamp repeats, goes back, or leaps by more than a year
  std::size_t imagesLeap = 0;        ///< of these, those that leap ahead
  std::size_t imagesNoStamp = 0;     ///< had no stamp: numbered one second apart
  std::size_t imagesUnpaired = 0;    ///< left out: no right image at their stamp
  double nearestRight = 0.0;         ///< of the first of these, how far away the nearest right one was [s]
  std::size_t imagesNoOdometry = 0;  ///< delivered without odometry although the rawlog holds some
  std::size_t odometry = 0;          ///< samples used
  std::size_t odometryBad = 0;       ///< left out: not a number
  std::size_t odometryWild = 0;      ///< left out: what no robot can have, see judgePose()
  std::size_t odometryBadStamp = 0;
  std::size_t odometryOther = 0;             ///< of another kind or label
  std::size_t clockRestarts = 0;             ///< the stamps went back for good
  std::size_t clockLeaps = 0;                ///< they leapt ahead by more than a year for good
  double firstStamp = 0.0, lastStamp = 0.0;  ///< of images and odometry [s]; 0 when there are none
  double pathLength = 0.0;                   ///< of the odometry used [m]
  std::string firstFailure;                  ///< why the first undecodable or missing image was left out
};

/// Frames of an MRPT rawlog: action/sensory-frame pairs, observations only, or both mixed; plain or gzip;
/// monocular and stereo, as CObservationStereoImages or as two cameras (`right_label`); images embedded or
/// outside. Streaming, in constant memory.
///
/// Stamps rise, except where the recorder's clock was set back for good, or leapt ahead by more than a year
/// (both counted, and no image is lost). Damage ends the stream: all before it is delivered, and problem()
/// says what is wrong and where. An image that is damaged in itself is left out.
class RawlogSource : public FrameSource {
 public:
  virtual const RawlogStats& stats() const = 0;
  /// The calibration that the last stereo frame came with; none when it had none that Engram knows.
  virtual const std::optional<cameras::StereoRig>& calibration() const = 0;
  /// That of the last frame of one camera. Where the rawlog does not say how the camera is mounted, it has
  /// the default mount.
  virtual std::optional<cameras::CameraRig> camera() const = 0;
  /// Damage that ended the stream early; empty otherwise.
  virtual std::string damage() const = 0;
  /// Whether nothing of the rawlog was lost so far. What problem() says besides is no more than a notice.
  bool whole() const { return damage().empty() && stats().imagesDamaged + stats().imagesMissing == 0; }
};

/// Throws base::Error when the file is missing, empty, unreadable or not a rawlog.
std::unique_ptr<RawlogSource> openRawlog(const std::string& path, const RawlogParams& params = {});

}  // namespace engram::sources
