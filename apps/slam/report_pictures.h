// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/exporters/html_report.h"
#include "engram/types/frame.h"
#include "engram/types/frame_report.h"

#include <cstddef>
#include <utility>
#include <vector>

namespace engram::apps {

/// Pictures of closures and of recognised images for a report: some all along the drive, however long it is.
class ReportPictures {
 public:
  static constexpr std::size_t kMost = 48;  ///< of either kind

  void add(const types::FrameReport& report, const types::Frame& frame);
  exporters::Pictures all() const;

 private:
  /// Each n-th that comes; when there are too many, every second goes and n doubles.
  struct Sample {
    std::vector<std::pair<exporters::Pictures::key_type, exporters::Pictures::mapped_type>> kept;
    std::size_t seen = 0, every = 1;
  };
  Sample closures_, recognised_;
};

}  // namespace engram::apps
