// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/rng.h"
#include "faulty_vfs.h"

#include <map>
#include <span>
#include <string>

namespace engram::store::test {

/// The bytes of all files, by path.
using Files = std::map<std::string, std::string>;

/// What is on the disk when the power fails after `events`: all that was synced; of what was not, any sectors
/// of 512 bytes, some of them torn, and any first part of the creations and deletions.
Files afterPowerCut(std::span<const DiskEvent> events, base::Rng& rng);

}  // namespace engram::store::test
