// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/bags/bag.h"

namespace engram::bags {

/// Each throws base::Error when the file cannot be opened or is none of its kind.
std::unique_ptr<BagReader> openRos1Bag(const std::string& path);
std::unique_ptr<BagReader> openMcapBag(const std::string& path);
std::unique_ptr<BagReader> openSqliteBag(const std::string& path);

}  // namespace engram::bags
