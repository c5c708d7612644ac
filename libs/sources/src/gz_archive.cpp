// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gz_archive.h"

#include "engram/base/output_file.h"

#include <cerrno>
#include <fcntl.h>
#include <stdexcept>
#include <sys/stat.h>
#include <unistd.h>

namespace engram::sources {

void failWriting(const std::string& path, int error) {
  if (error == EPIPE && path == base::kStandardOutput) throw base::ClosedPipe();
  throw base::Error(path + ": cannot be written: " + base::reasonOf(error));
}

GzArchive::GzArchive(int descriptor, std::string path) : path_(std::move(path)), descriptor_(descriptor) {
  file_ = gzdopen(::fcntl(descriptor_, F_DUPFD_CLOEXEC, 0), "wb1");  // the images are compressed already
  if (file_) return;
  const int error = errno;
  ::close(descriptor_);
  failWriting(path_, error);
}

GzArchive::~GzArchive() {
  if (file_) gzclose_w(file_);
  ::close(descriptor_);
}

void GzArchive::flush(bool sync) {
  errno = 0;
  if (dirty_ && gzflush(file_, Z_FINISH) != Z_OK) failWriting(path_, errno);
  if (dirty_ && sync) toDisk();
  if (dirty_) whole_ = size();
  dirty_ = false;
}

void GzArchive::finish() {
  gzFile file = file_;
  file_ = nullptr;
  errno = 0;
  if (gzclose_w(file) != Z_OK) failWriting(path_, errno);
  toDisk();
  whole_ = size();
}

void GzArchive::toDisk() const {
  if (const int error = base::syncFile(descriptor_); error != 0) failWriting(path_, error);
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
    failWriting(path_, errno);
}

size_t GzArchive::read(void*, size_t) { throw std::logic_error("GzArchive is for writing"); }

}  // namespace engram::sources
