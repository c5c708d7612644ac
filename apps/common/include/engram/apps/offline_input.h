// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/sources/rawlog_source.h"
#include "engram/types/frame.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace engram::apps {

/// The images of a run that are there already: of a rawlog, of image files, or of a video; all, or a part.
class OfflineInput {
 public:
  void declare(CLI::App& app);
  bool given() const { return !path().empty(); }
  bool isOpen() const { return source_ != nullptr; }
  /// Throws UsageError when more than one is given, and as the sources do.
  void open(const sources::RawlogParams& params);

  /// The rawlog, the folder of images, or the video.
  const std::string& path() const;
  /// The name of that file, with the part of it that is used.
  std::string name() const;
  /// The image that next() will return first; null when there is none.
  const types::Frame* peek();
  std::optional<types::Frame> next();
  double progress() const;
  std::string problem() const;
  /// Whether nothing of it was lost.
  bool whole() const;

  /// The calibration that came with the first image, as a calibration file; empty when none did that fits it.
  std::string calibration(bool stereo);

 private:
  std::optional<types::Frame> nextInRange();

  std::string rawlog_, images_, right_, stamps_, csv_, video_;
  std::uint64_t from_ = 0, every_ = 1;
  std::optional<std::uint64_t> to_;

  std::unique_ptr<sources::FrameSource> source_;
  sources::RawlogSource* rawlogSource_ = nullptr;  // source_, where it is one
  std::optional<types::Frame> peeked_;
  std::uint64_t seen_ = 0, last_ = 0;
  bool any_ = false;
};

}  // namespace engram::apps
