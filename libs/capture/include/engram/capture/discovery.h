// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace engram::capture {

struct CameraInfo {
  std::string id;  ///< what `camera` of a configuration takes
  std::string vendor, model, serial;
  std::string address;   ///< of the network; the address serves as id as well
  std::string protocol;  ///< "GigEVision", "USB3Vision", "Fake"
};

/// Asks all networks of this computer for cameras; takes a second.
std::vector<CameraInfo> discover();

/// Offers Aravis' simulated camera `Fake_1`, which needs no network. An id that begins with "Fake_" does the
/// same.
void enableFakeCamera();

}  // namespace engram::capture
