// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/rawlog_writer.h"
#include "engram/types/frame.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace engram::capture {

struct RecorderParams {
  sources::RawlogWriterParams writer{};
  double rotate_mb = 0.0;  ///< a new file after so much [MB]; 0: never
  double rotate_s = 0.0;   ///< a new file after so long by the stamps of the images [s]; 0: never
  double flush_s = 0.5;    ///< a crash loses no more than this [s]
};

/// Records live, to one rawlog or, with rotation, to `name_001.rawlog`, `name_002.rawlog`, …
class Recorder {
 public:
  struct File {
    std::string path;
    std::size_t frames = 0;  ///< that are safe on the disk
    std::uint64_t bytes = 0;
  };

  /// Throws base::Error when a file of that name exists and may not be overwritten, or cannot be made.
  Recorder(const std::string& path, const RecorderParams& params);

  /// Throw base::Error when the disk is full; files() then says what is safe.
  void add(const types::Frame& frame);
  void addObject(const mrpt::serialization::CSerializable& object);
  /// To be called often, also while nothing comes. @param now [s] of any steady clock
  void tick(double now);
  void close();

  std::vector<File> files() const;
  std::size_t framesSafe() const;

 private:
  void openNext();
  bool isFull(double stamp) const;
  void finishFile();

  std::string path_;
  RecorderParams params_;
  std::vector<File> done_;
  std::unique_ptr<sources::RawlogWriter> writer_;
  std::string current_;
  double firstStamp_ = 0.0;  // of the current file
  double lastFlush_ = 0.0;
  bool unflushed_ = false;
};

}  // namespace engram::capture
