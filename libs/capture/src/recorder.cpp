// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/recorder.h"

#include "engram/base/error.h"

#include <cstdio>
#include <filesystem>

namespace engram::capture {
namespace {

namespace fs = std::filesystem;

std::string numbered(const std::string& path, std::size_t n) {
  char number[16];
  std::snprintf(number, sizeof number, "_%03zu", n);
  const fs::path file(path);
  return (file.parent_path() / (file.stem().string() + number + file.extension().string())).string();
}

}  // namespace

Recorder::Recorder(const std::string& path, const RecorderParams& params) : path_(path), params_(params) {
  params_.writer.live = true;
  const bool rotates = params.rotate_mb > 0 || params.rotate_s > 0;
  // Found out now, not in the middle of the recording.
  for (std::size_t n = 1; rotates && !params.writer.overwrite && n <= 999; ++n)
    if (fs::exists(numbered(path, n)))
      throw base::Error(numbered(path, n) + ": exists already; choose another name or give --overwrite");
  openNext();
}

void Recorder::openNext() {
  const bool rotates = params_.rotate_mb > 0 || params_.rotate_s > 0;
  current_ = rotates ? numbered(path_, done_.size() + 1) : path_;
  writer_ = std::make_unique<sources::RawlogWriter>(current_, params_.writer);
}

bool Recorder::isFull(double stamp) const {
  if (writer_->frames() == 0) return false;
  const bool large =
      params_.rotate_mb > 0 && static_cast<double>(writer_->bytes()) >= params_.rotate_mb * 1e6;
  return large || (params_.rotate_s > 0 && stamp - firstStamp_ >= params_.rotate_s);
}

void Recorder::add(const types::Frame& frame) {
  if (isFull(frame.stamp)) {
    finishFile();
    openNext();
  }
  if (writer_->frames() == 0) firstStamp_ = frame.stamp;
  writer_->add(frame);
  unflushed_ = true;
}

void Recorder::addObject(const mrpt::serialization::CSerializable& object) {
  writer_->addObject(object);
  unflushed_ = true;
}

void Recorder::tick(double now) {
  if (!unflushed_ || now - lastFlush_ < params_.flush_s) return;
  writer_->flush();
  lastFlush_ = now;
  unflushed_ = false;
}

void Recorder::finishFile() {
  writer_->close();
  done_.push_back({current_, writer_->framesSafe(), writer_->bytes()});
  unflushed_ = false;
}

void Recorder::close() {
  if (!writer_) return;
  finishFile();
  writer_.reset();
}

std::vector<Recorder::File> Recorder::files() const {
  auto all = done_;
  if (writer_) all.push_back({current_, writer_->framesSafe(), writer_->bytes()});
  return all;
}

std::size_t Recorder::framesSafe() const {
  std::size_t frames = 0;
  for (const auto& file : files()) frames += file.frames;
  return frames;
}

}  // namespace engram::capture
