// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/cameras/stereo_rig.h"
#include "engram/types/frame.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace mrpt::serialization {
class CSerializable;
}

namespace engram::sources {

/// A stamp [s] as a rawlog will hold it, in steps of 100 ns; NaN when it cannot.
double stampAsRecorded(double stamp);

struct RawlogWriterParams {
  std::string sensor_label = "CAMERA";
  std::string odometry_label = "ODOMETRY";
  int jpeg_quality = 90;         ///< 1 … 100
  bool external_images = false;  ///< as files in `<rawlog name>_Images` instead of inside the rawlog
  /// Keep the labels of the frames, the names of their image files: as CObservationComment, which MRPT's
  /// programs pass on and show. Truth refers to these names.
  bool file_names = false;
  std::optional<cameras::StereoRig> stereo;  ///< calibration to write with stereo pairs
  /// The same with images of one camera, those of its size; of a camera that is no pinhole MRPT knows only
  /// that.
  std::optional<cameras::CameraRig> camera;
  bool overwrite = false;  ///< replace an existing rawlog (and its folder of images)
  bool live = false;       ///< what is written cannot be made again: keep it whatever happens
  bool sync = true;  ///< flush() waits for the disk; false: for the system alone, which outlives this program
};

/// Writes frames as a gzip rawlog of observations: for each frame CObservationOdometry where there is
/// odometry (its part in the plane), then CObservationImage or, with a right image, CObservationStereoImages,
/// as JPEG. MRPT 2.x reads it. Everything goes to a temporary file and gets its name only in close(): there
/// is never half a rawlog. A device, a pipe or standard output ("-") is written through.
///
/// A live recording has its name from the first object on; until then an earlier file stays. At every flush()
/// it is a whole rawlog; a crash loses what came after the last one, and so does a full disk.
class RawlogWriter {
 public:
  /// Throws base::Error when the path exists (and overwrite is false) or cannot be written.
  explicit RawlogWriter(const std::string& path, const RawlogWriterParams& params = {});
  /// Without close() nothing is left behind; of a live recording, everything.
  ~RawlogWriter();
  RawlogWriter(const RawlogWriter&) = delete;
  RawlogWriter& operator=(const RawlogWriter&) = delete;

  /// Throws base::Error when the disk is full, the image cannot be encoded, or the stamp is none for a
  /// rawlog.
  void add(const types::Frame& frame);
  /// The same; returns the frame as openRawlog() will read it back, bit for bit: after JPEG, and with stamp
  /// and odometry as the rawlog holds them.
  types::Frame addReplayable(const types::Frame& frame);
  /// Any other object of MRPT.
  void addObject(const mrpt::serialization::CSerializable& object);
  /// Brings everything to the disk as a whole rawlog. Throws base::Error.
  void flush();
  /// Writes the rest, makes sure it is on the disk and gives the file its name. Throws base::Error.
  void close();

  std::size_t frames() const;      ///< added
  std::size_t framesSafe() const;  ///< of them, those that the last flush() or close() brought to the disk
  std::uint64_t bytes() const;     ///< on the disk so far, with images stored outside

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace engram::sources
