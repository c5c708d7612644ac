// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace engram::capture {

/// What a camera says of itself, and how it is set.
struct CameraSettings {
  std::string id, vendor, model, serial, address, format;
  int width = 0, height = 0;     ///< [px]
  double frameRate = 0.0;        ///< [images/s]; 0: the camera does not say
  std::size_t payload = 0;       ///< of an image [bytes]
  int packetSize = 0;            ///< [bytes]; 0: no network camera
  std::size_t socketBuffer = 0;  ///< that was asked for [bytes]; 0: no network camera
  std::size_t socketLimit = 0;   ///< net.core.rmem_max [bytes]; 0: no network camera or unknown
};

struct PacketStats {
  std::uint64_t resent = 0, missing = 0;  ///< packets
  std::uint64_t underruns = 0;            ///< images that found no free buffer
  PacketStats& operator+=(const PacketStats& o);
};

/// A time without images, from the last image before to the first after it [s since the Unix epoch].
struct Gap {
  double from = 0.0, to = 0.0;
};

/// What became of the images of one camera.
struct CameraStats {
  CameraSettings settings;
  std::size_t whole = 0;       ///< arrived whole
  std::size_t incomplete = 0;  ///< arrived with packets missing: dropped
  std::size_t missed = 0;      ///< taken by the camera but never seen, by the numbers of the images
  std::size_t cuts = 0;        ///< times the camera was lost; each may cut an image short
  std::size_t reconnects = 0;
  std::size_t clockRestarts = 0;  ///< times that the camera's clock was related to the host's anew
  double clockDrift = 0.0;        ///< how much faster the host's clock runs [s/s]
  PacketStats packets;
  std::vector<Gap> gaps;  ///< while the camera was lost
};

/// Of one camera, or of two.
struct GrabStats {
  std::vector<CameraStats> cameras;
  std::size_t frames = 0;    ///< handed on: images, or pairs of them
  std::size_t unpaired = 0;  ///< images without a partner in the other camera

  std::size_t incomplete() const;
  std::size_t missed() const;
  std::size_t reconnects() const;
  /// Images that the cameras took and that were not handed on, as far as can be known.
  std::size_t lost() const { return incomplete() + missed() + unpaired; }
};

/// Why images are lost and which setting helps, for a message; empty when none were.
std::string adviceOnLoss(const GrabStats& stats);

}  // namespace engram::capture
