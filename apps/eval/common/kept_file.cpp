// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/kept_file.h"

#include "engram/base/atomic_file.h"

namespace engram::apps {

void writeKept(const std::string& path, const nlohmann::json& content) {
  base::writeText(path, toText(content), true);
}

}  // namespace engram::apps
