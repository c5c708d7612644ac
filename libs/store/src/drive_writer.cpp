// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/drive_writer.h"

#include "engram/base/error.h"
#include "engram/store/report_json.h"
#include "server.h"

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <utility>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

/// Records of a camera that sees nothing for days must not fill the memory.
constexpr std::size_t kMostHeld = 4096;

/// Whether there is a map: its making may have been cut off before it held anything.
bool hasMap(const std::string& path) {
  std::error_code error;
  return MapFile::exists(path) && !(fs::is_regular_file(path) && fs::file_size(path, error) == 0);
}

/// What tells the part of a drive that was spooled.
constexpr const char* kSpooled = " (spooled)";

std::string freeSpool(const std::string& schema) {
  std::string name = schema + ".spool";
  for (int i = 2; fs::exists(name); ++i) name = schema + ".spool-" + std::to_string(i);
  return name;
}

std::vector<types::FrameReport> recordsOf(const Drive& drive, std::vector<types::FrameReport> all) {
  const auto first =
      all.end() - static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(drive.images, all.size()));
  return {std::make_move_iterator(first), std::make_move_iterator(all.end())};
}

}  // namespace

DriveWriter::DriveWriter(const std::string& path, const DriveOptions& options, std::string source,
                         const types::Frame* first)
    : path_(path), source_(std::move(source)), options_(options) {
  const bool exists = options.resume ? hasMap(path) : MapFile::exists(path);
  if (exists && (options.extend || options.resume)) {
    openExisting(first);
    return;
  }
  if (options.extend) throw base::Error("map '" + path + "' does not exist");
  if (exists && !options.overwrite)
    throw base::Error(path +
                      " exists; give --overwrite to replace it, --extend to go on with it, or --resume "
                      "to finish a drive that was cut off");
  options_.overwrite |= options.resume;  // of what its making left
  if (!isOnServer(path)) lock_.emplace(path);
}

void DriveWriter::openExisting(const types::Frame* first) {
  file_ = MapFile::open(path_, Access::kReadWrite);
  if (isOnServer(path_)) drives_ = file_->drives();
  if (!options_.resume) return;
  const auto drives = file_->drives();
  const bool same = !drives.empty() && first != nullptr && drives.back().fingerprint == fingerprintOf(*first);
  if (!same) {
    const bool untouched =
        drives.empty() && file_->records().empty();  // it was cut off before its first image
    if (options_.extend || untouched) return;
    throw base::Error("map '" + path_ + "': there is nothing to resume: " +
                      (drives.empty()
                           ? "it does not know its drives"
                           : "the last one is " + describe(drives.back()) + ", which begins otherwise") +
                      ". Give --extend to add this drive");
  }
  complete_ = drives.back().finished;
  resumes_ = !complete_;
  if (resumes_) recorded_ = recordsOf(drives.back(), file_->records());
}

map::TopologicalMap DriveWriter::load() {
  if (!file_) return {};
  map::TopologicalMap map = resumes_ ? file_->loadBeforeLastDrive() : file_->loadOnDemand();
  stored_ = map.now();
  return map;
}

void DriveWriter::forget(const map::TopologicalMap& map, int firstKeptSession) {
  if (resumes_ || !file_) return;
  file_->commit(map, map.changesSince(stored_));
  file_->forgetRecords(firstKeptSession);
}

void DriveWriter::requireNew(std::uint32_t fingerprint) const {
  if (options_.again) return;
  for (const Drive& drive : file_->drives()) {
    if (drive.fingerprint != fingerprint) continue;
    throw base::Error("map '" + path_ + "' has learnt '" + source_ + "' already: " + describe(drive) +
                      (drive.finished ? "" : ", cut off; --resume goes on with it") +
                      ". Give --again to learn it once more all the same");
  }
}

void DriveWriter::begin(const types::Frame& first, int session, const map::MapHeader& header) {
  if (resumes_) return;
  const std::uint32_t fingerprint = fingerprintOf(first);
  if (file_) requireNew(fingerprint);
  newHeader_ = header;
  next_ = {.session = session,
           .source = note_.empty() ? source_ : source_ + "; " + note_,
           .fingerprint = fingerprint,
           .firstStamp = first.stamp,
           .lastStamp = first.stamp};
}

/// A robot without network goes on: its map is a file from now on.
void DriveWriter::goOnInSpool(const map::TopologicalMap& map, const types::FrameReport* report) {
  WholeMap whole{file_->header(), map.content(), drives_, {}, 0, {}};
  Drive drive = next_ ? *next_ : drives_.back();
  if (!next_ && report != nullptr) {  // a drive of its own in the file: its images so far are on the server
    drive.source += kSpooled;
    drive.firstStamp = report->stamp;
  }
  if (!drives_.empty()) whole.firstRecord = drives_.back().firstRecord + drives_.back().images;
  std::vector<types::FrameReport> reports = held_;
  if (reports.empty() && report != nullptr) reports.push_back(*report);
  const std::string name = freeSpool(parseAddress(path_).schema);
  MapFile local = MapFile::create(name, whole.header);
  local.replace(whole);
  local.beginDrive(drive);
  stored_ = map.now();
  map::Cursor nothing = stored_;
  local.commit(map, map.changesSince(nothing), reports);
  file_ = std::move(local);
  spool_ = name;
  next_.reset();
  held_.clear();
}

std::string DriveWriter::notice() const {
  if (spool_.empty()) return {};
  return "the server of the map went away: the drive goes on in '" + spool_ +
         "'. When the server is back: engram-map merge '" + path_ + "' " + spool_ + " --into";
}

void DriveWriter::commit(const map::TopologicalMap& map, const types::FrameReport& report) {
  try {
    write(map, report);
  } catch (const ServerAway&) {
    if (!file_) throw;  // a map that the server does not have yet
    goOnInSpool(map, &report);
  }
}

void DriveWriter::write(const map::TopologicalMap& map, const types::FrameReport& report) {
  if (!next_) {
    file_->commit(map, map.changesSince(stored_), &report);
    if (!drives_.empty()) ++drives_.back().images;
    return;
  }
  held_.push_back(report);
  const bool use = report.outcome != types::Outcome::kUnusable && report.outcome != types::Outcome::kSkipped;
  if (!use && held_.size() < kMostHeld) return;
  if (!file_)
    file_ = lock_ ? MapFile::create(std::move(*lock_), newHeader_, options_.overwrite)
                  : MapFile::create(path_, newHeader_, options_.overwrite);
  file_->beginDrive(*next_);
  if (isOnServer(path_)) drives_ = file_->drives();
  next_.reset();
  file_->commit(map, map.changesSince(stored_), held_);
  if (!drives_.empty()) drives_.back().images += held_.size();
  held_.clear();
}

void DriveWriter::add(const map::TopologicalMap& map, const types::FrameReport& report) {
  if (added_++ >= recorded_.size()) return commit(map, report);
  const types::FrameReport& before = recorded_[added_ - 1];
  if (toJson(report, false) != toJson(before, false))
    throw base::Error("map '" + path_ + "': image " + std::to_string(report.index) + " of '" + source_ +
                      "' is not what was recorded of it. To resume needs the same rawlog, configuration and "
                      "program; the map was not changed");
  if (added_ < recorded_.size()) return;
  file_->resumeDrive(map, map.changesSince(stored_));
  if (isOnServer(path_)) drives_ = file_->drives();
}

void DriveWriter::end(const map::TopologicalMap& map, bool whole) {
  // What a resumed drive has not come to yet stays as it is in the file.
  if (added_ < recorded_.size() || next_) return;
  try {
    file_->commit(map, map.changesSince(stored_));
    if (whole) file_->endDrive();
  } catch (const ServerAway&) {
    goOnInSpool(map, nullptr);
    if (whole) file_->endDrive();
  }
}

void DriveWriter::keep(std::span<const map::DerivedRow> rows) {
  if (!file_ || next_) return;
  try {
    file_->keep(rows);
  } catch (const ServerAway&) {
    // The map is whole without them.
  }
}

}  // namespace engram::store
