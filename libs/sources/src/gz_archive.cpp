// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gz_archive.h"

#include "engram/base/error.h"

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <stdexcept>
#include <sys/stat.h>
#include <unistd.h>

namespace engram::sources {

void failWriting(const std::string& path, int error) {
  const std::string hint =
      error == ENOSPC || error == EFBIG || error == EDQUOT ? "; free some space or choose another disk" : "";
  throw base::Error(path + ": cannot be written: " + std::strerror(error) + hint);
}

GzArchive::GzArchive(std::string path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) failWriting(path_, errno);
  file_ = gzdopen(::dup(descriptor_), "wb1");  // the images are compressed already
  if (!file_) failWriting(path_, errno);
}

GzArchive::~GzArchive() {
  if (file_) gzclose_w(file_);
  ::close(descriptor_);
}

void GzArchive::flush(bool sync) {
  errno = 0;
  if (dirty_ && (gzflush(file_, Z_FINISH) != Z_OK || (sync && ::fdatasync(descriptor_) != 0)))
    failWriting(path_, errno != 0 ? errno : EIO);
  if (dirty_) whole_ = size();
  dirty_ = false;
}

void GzArchive::finish() {
  gzFile file = file_;
  file_ = nullptr;
  errno = 0;
  if (gzclose_w(file) != Z_OK || ::fsync(descriptor_) != 0) failWriting(path_, errno != 0 ? errno : EIO);
  whole_ = size();
}

void GzArchive::cutBack() noexcept {
  if (file_) gzclose_w(file_);
  file_ = nullptr;
  [[maybe_unused]] const int ignored = ::ftruncate(descriptor_, static_cast<off_t>(whole_));
}

std::uint64_t GzArchive::size() const {
  struct stat status {};
  return ::fstat(descriptor_, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

void GzArchive::bytes(const void* data, std::size_t n) {
  if (!file_) throw std::logic_error("GzArchive: written after its end");
  errno = 0;
  dirty_ = dirty_ || n > 0;
  if (n > 0 && gzwrite(file_, data, static_cast<unsigned>(n)) != static_cast<int>(n))
    failWriting(path_, errno != 0 ? errno : EIO);
}

size_t GzArchive::read(void*, size_t) { throw std::logic_error("GzArchive is for writing"); }

}  // namespace engram::sources
