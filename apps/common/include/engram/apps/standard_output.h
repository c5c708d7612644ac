// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <ostream>

namespace engram::apps {

/// Standard output as a stream that loses no failure: the write that fails throws base::Error with the
/// reason, or base::ClosedPipe, and so does flush(). On a terminal every output is shown at once.
class StandardOutput : public std::ostream {
 public:
  StandardOutput();
  ~StandardOutput() override;
  StandardOutput(const StandardOutput&) = delete;
  StandardOutput& operator=(const StandardOutput&) = delete;

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
};

}  // namespace engram::apps
