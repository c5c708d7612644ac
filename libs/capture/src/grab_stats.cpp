// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/grab_stats.h"

#include <algorithm>

namespace engram::capture {
namespace {

template <class Member>
std::size_t sum(const GrabStats& stats, Member member) {
  std::size_t total = 0;
  for (const auto& camera : stats.cameras) total += camera.*member;
  return total;
}

/// What to set so that two images fit in the buffer of the socket, which must hold what comes while the
/// receiving thread is not running; empty when they do.
std::string adviceOnSocket(const CameraSettings& s) {
  const std::size_t needed = 2 * s.payload;
  const auto advice = [&](const std::string& has, const std::string& set) {
    return "; an image has " + std::to_string(s.payload) + " bytes, " + has + ": " + set;
  };
  if (s.socketBuffer > 0 && s.socketBuffer < needed)
    return advice("the socket a buffer of " + std::to_string(s.socketBuffer),
                  "raise socket_buffer_mb to " + std::to_string((needed >> 20) + 1));
  if (s.socketLimit > 0 && s.socketLimit < needed)
    return advice(
        "the system allows a socket buffer of " + std::to_string(s.socketLimit),
        "as root, sysctl -w net.core.rmem_max=" + std::to_string(std::max(std::size_t{8} << 20, 2 * needed)));
  return {};
}

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
    const std::string socket = adviceOnSocket(s);
    advice += socket;
    if (socket.empty() && camera.incomplete > camera.cuts && s.packetSize > 0)
      advice +=
          "; packets are lost on the way: raise packet_delay_us (and packet_size where all switches and "
          "the interface take jumbo frames), or lower frame_rate";
  }
  return advice.empty() ? advice : advice.substr(2);
}

}  // namespace engram::capture
