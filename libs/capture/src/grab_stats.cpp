// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/grab_stats.h"

namespace engram::capture {
namespace {

template <class Member>
std::size_t sum(const GrabStats& stats, Member member) {
  std::size_t total = 0;
  for (const auto& camera : stats.cameras) total += camera.*member;
  return total;
}

/// Bytes of an image that must fit in the buffer of the socket while the receiving thread is not running.
bool socketTooSmall(const CameraSettings& s) { return s.socketLimit > 0 && s.socketLimit < 2 * s.payload; }

}  // namespace

PacketStats& PacketStats::operator+=(const PacketStats& o) {
  resent += o.resent;
  missing += o.missing;
  underruns += o.underruns;
  return *this;
}

std::size_t GrabStats::incomplete() const { return sum(*this, &CameraStats::incomplete); }
std::size_t GrabStats::missed() const { return sum(*this, &CameraStats::missed); }
std::size_t GrabStats::reconnects() const { return sum(*this, &CameraStats::reconnects); }

std::string adviceOnLoss(const GrabStats& stats) {
  std::string advice;
  for (const auto& camera : stats.cameras) {
    const CameraSettings& s = camera.settings;
    if (camera.incomplete + camera.missed == 0) continue;
    if (camera.packets.underruns > 0)
      advice += "; " + std::to_string(camera.packets.underruns) +
                " images found no free buffer: raise buffers, or lower frame_rate: this computer is too slow";
    if (socketTooSmall(s))
      advice += "; an image has " + std::to_string(s.payload) +
                " bytes, the system allows a socket buffer of " + std::to_string(s.socketLimit) +
                ": as root, sysctl -w net.core.rmem_max=" +
                std::to_string(std::size_t{8} << 20 > 4 * s.payload ? std::size_t{8} << 20 : 4 * s.payload);
    else if (camera.incomplete > 0 && s.packetSize > 0)
      advice +=
          "; packets are lost on the way: raise packet_delay_us (and packet_size where all switches and "
          "the interface take jumbo frames), or lower frame_rate";
  }
  return advice.empty() ? advice : advice.substr(2);
}

}  // namespace engram::capture
