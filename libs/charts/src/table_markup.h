// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/charts/page.h"

namespace engram::charts {

/// The table alone, without its caption. Throws base::Error when a row is not as long as the header.
std::string markup(const Table& table);

}  // namespace engram::charts
