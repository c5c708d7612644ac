// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/static_view.h"
#include "recognise_steps.h"
#include "scan_poses.h"
#include "tree_search.h"

#include <memory>
#include <optional>
#include <vector>

namespace engram::pipeline {

// Maps of reference scans (V: Bertolli, Jensfelt & Christensen 2006): a stereo view is a scan whose points
// have descriptors; some become references, one image late (V-08).

/// The last scan that was taken up: it may become a reference yet.
struct HeldScan {
  types::Frame frame;
  types::Features features;
  cv::Mat picture;
  std::vector<Link> links;  ///< to references
  base::PlaceId anchor;     ///< the reference that it hangs on; invalid before there is one
  types::RelPose T_anchor_scan;
  bool guessed = false;                       ///< nothing measured the way from there
  std::optional<types::RelPose> T_made_scan;  ///< by the wheels alone, from the reference made last
};

/// What the steps of scans share: the poses of either back-end, the scan before, and the index of references.
struct ScanTrack {
  explicit ScanTrack(const Run& run) : poses(makeScanPoses(run)), search(run.params) { search.load(run.map); }

  /// Whether the robot is known well enough for references to be sought in a window.
  bool sharp(const Run& run) const;

  std::unique_ptr<ScanPoses> poses;
  TreeSearch search;
  std::optional<HeldScan> held;
  types::RelPose motion;  ///< from the scan before that to it, for a robot without wheels
  bool guessed = false;   ///< nothing has measured the way since the anchor
  base::PlaceId made;     ///< the reference made last in this drive
  std::optional<types::RelPose> T_made_robot, lastStep;  ///< by the wheels alone
};

/// V-01 to V-03: both eyes become a scan.
class ScanPerceive final : public PerceiveStep {
 public:
  std::optional<Seen> perceive(Run& run, const types::Frame& frame, types::FrameReport& report) override;
};

/// V-04: the references that the robot should be able to match, nearest first, after one step on.
class NearStep final : public RecogniseStep {
 public:
  explicit NearStep(std::shared_ptr<ScanTrack> track) : track_(std::move(track)) {}
  Evidence recognise(Run& run, const Keyframe& image, types::FrameReport& report) override;
  void restart() override;

 private:
  types::RelPose stepOf(const Run& run);
  std::shared_ptr<ScanTrack> track_;
};

/// Each candidate in its window; without success all references by descriptors (V-11, V-E7); and the scan
/// before.
class ScansVerify final : public VerifyStep {
 public:
  explicit ScansVerify(std::shared_ptr<ScanTrack> track) : track_(std::move(track)) {}
  Verified verify(Run& run, const Keyframe& image, Evidence evidence, types::FrameReport& report) override;

 private:
  void recover(Run& run, const Keyframe& image, Verified& verified, types::FrameReport& report) const;
  std::shared_ptr<ScanTrack> track_;
};

/// V-08: an image that matches no reference, but the scan before, makes that one a reference.
class ScanDecide final : public DecideStep {
 public:
  explicit ScanDecide(std::shared_ptr<ScanTrack> track) : track_(std::move(track)) {}
  Decision decide(Run& run, const Keyframe& image, const Verified& verified,
                  types::FrameReport& report) override;

 private:
  void begin(Run& run, const Verified& verified, Decision& decision, types::FrameReport& report) const;
  void measure(Run& run, const Keyframe& image, const Verified& verified, Decision& decision,
               types::FrameReport& report);
  static bool isThin(const Run& run, const Verified& verified);
  void contradict(Run& run, const Keyframe& image, const Verified& verified, Decision& decision);

  std::shared_ptr<ScanTrack> track_;
  Landings landings_;
};

/// The scan before becomes a node, by the pose that it has.
class ScanRemember final : public RememberStep {
 public:
  explicit ScanRemember(std::shared_ptr<ScanTrack> track) : track_(std::move(track)) {}
  base::PlaceId remember(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                         types::FrameReport& report) override;

 private:
  memory::Static memory_;
  std::shared_ptr<ScanTrack> track_;
};

/// A new reference is joined to those that it matched; where it matched none, by the way of the robot (V-E8).
class ScanRelate final : public RelateStep {
 public:
  explicit ScanRelate(std::shared_ptr<ScanTrack> track) : track_(std::move(track)) {}
  Relation relate(Run& run, const Keyframe& image, const Verified& verified, const Decision& decision,
                  base::PlaceId node, types::FrameReport& report) override;

 private:
  void join(Run& run, const HeldScan& scan, Relation& relation) const;
  void hold(const Run& run, const Keyframe& image, std::vector<Link> links) const;
  std::shared_ptr<ScanTrack> track_;
};

class ScanRelax final : public RelaxStep {
 public:
  explicit ScanRelax(std::shared_ptr<ScanTrack> track) : track_(std::move(track)) {}
  void relax(Run& run, const Relation& relation, types::FrameReport& report) override;
  void finish(Run& run) override { track_->poses->finish(run); }

 private:
  std::shared_ptr<ScanTrack> track_;
};

}  // namespace engram::pipeline
