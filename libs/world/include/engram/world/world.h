// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/camera_rig.h"
#include "engram/sources/frame_source.h"
#include "engram/types/frame.h"
#include "engram/world/drive.h"
#include "engram/world/library.h"
#include "engram/world/renderer.h"
#include "engram/world/scene.h"
#include "engram/world/schedule.h"

#include <Eigen/Geometry>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace engram::world {

struct WorldParams {
  std::uint64_t seed = 1;
  std::string photographs;  ///< folder of images for the posters; empty: painted ones
  ChangeParams change;
  DriveParams drive;
  SensorParams sensor;
};

/// The camera or cameras on the robot.
struct Eyes {
  std::string name;         ///< omni, pinhole, stereo, or the file
  cameras::CameraRig left;  ///< the only one, or the left one
  std::optional<cameras::CameraRig> right;
};

/// `omni`, `pinhole` or `stereo`: the calibrations of share/cameras. Throws base::Error on another name.
Eyes presetEyes(const std::string& name);

/// A building with its textures, its tour and its calendar. The base of all sessions; it must outlive them.
class World {
 public:
  World(const Plan& plan, const WorldParams& params);
  static World preset(const std::string& name, const WorldParams& params) {
    return {presetPlan(name, params.seed), params};
  }

  const Plan& plan() const { return building_.plan(); }
  const Building& building() const { return building_; }
  const Library& library() const { return library_; }
  const Route& route() const { return route_; }
  const WorldParams& params() const { return params_; }
  /// What the building looks like in session `number` (from 1).
  Appearance appearance(int number) const { return Schedule(building_, params_.change).session(number); }

 private:
  WorldParams params_;
  Building building_;
  Library library_;
  Route route_;
};

/// One drive through the world on one day. Frames are rendered on demand, in any order, from any thread.
class Session {
 public:
  /// @param number which day, from 1. @param kind tour or test drive
  Session(const World& world, int number, Eyes eyes, DriveKind kind = DriveKind::kTour, int threads = 1);

  std::size_t size() const { return drive_.imageTimes().size(); }
  /// Image i as a source would deliver it, with odometry. @param threads for this one image
  types::Frame frame(std::size_t i, int threads = 1) const;
  double stamp(std::size_t i) const { return start_ + drive_.imageTimes()[i]; }  ///< Unix time [s]
  Eigen::Isometry3d T_world_robot(std::size_t i) const;
  /// Nearest station along the nominal tour.
  int place(std::size_t i) const;

  const Appearance& appearance() const { return appearance_; }
  const Scene& scene() const { return scene_; }
  const Drive& drive() const { return drive_; }
  const Eyes& eyes() const { return eyes_; }
  double startStamp() const { return start_; }
  /// People at a time since the start [s]; they step aside for the robot.
  std::vector<Pillar> peopleAt(double t) const;

 private:
  Shot shotAt(std::size_t i, const cameras::CameraRig& rig) const;
  void meterAll();

  const World& world_;
  Eyes eyes_;
  Appearance appearance_;
  Scene scene_;
  Drive drive_;
  double start_;
  std::uint64_t seed_;
  Renderer left_;
  std::optional<Renderer> right_;
  std::vector<Exposure> exposures_;
};

/// The picture of one camera at a pose, as a session would take it.
cv::Mat renderAt(const World& world, const Appearance& appearance, const cameras::CameraRig& rig,
                 const Pose2& T_world_robot, int threads = 1);
/// The same with people in it, by a renderer at hand. @param seed of the noise
cv::Mat renderAt(const Scene& scene, const Renderer& renderer, const Eigen::Isometry3d& T_world_cam,
                 const std::vector<Pillar>& people, std::uint64_t seed, int threads = 1);

/// People who walk along the route, some time after they set out [s]; they step aside for the robot.
std::vector<Pillar> walkers(const World& world, int people, std::uint64_t seed, double t, const Pose2& robot);

/// The frames of a session as a source.
class WorldSource : public sources::FrameSource {
 public:
  explicit WorldSource(std::shared_ptr<const Session> session, int threads = 1)
      : session_(std::move(session)), threads_(threads) {}
  std::optional<types::Frame> next() override;
  double progress() const override {
    return session_->size() ? static_cast<double>(next_) / static_cast<double>(session_->size()) : 1.0;
  }
  std::string problem() const override { return {}; }

 private:
  std::shared_ptr<const Session> session_;
  int threads_;
  std::size_t next_ = 0;
};

}  // namespace engram::world
