// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace engram::base {

/// A text file that grows by whole lines while a program works, so that a run of days needs no memory for it
/// and a crash loses none.
class LineFile {
 public:
  /// An empty path writes nothing; "-" is standard output.
  explicit LineFile(std::string path) : path_(std::move(path)) {}
  ~LineFile();
  LineFile(const LineFile&) = delete;
  LineFile& operator=(const LineFile&) = delete;
  bool wanted() const { return !path_.empty(); }

  /// The first line begins the file and replaces an old one; throws base::Error when it cannot. After a later
  /// failure, such as a full disk, nothing more is written: it must not end the work that the lines tell of.
  /// A standard output whose reader has gone does end it, by ClosedPipe.
  void add(const std::string& line);
  /// Why lines are missing, with the name of the file; empty when none is.
  const std::string& failure() const { return failure_; }

 private:
  std::string path_, failure_;
  int descriptor_ = -1;
};

}  // namespace engram::base
