// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/writer_lock.h"

#include "engram/base/error.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace engram::store {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& mapPath, int error) {
  const bool readOnly = error == EACCES || error == EROFS || error == EPERM;
  throw base::Error(
      "map '" + mapPath + "': it cannot be locked for writing (" + std::strerror(error) + "). " +
      (readOnly ? "Its folder is read-only for you" : "Does its folder exist, and has it room?"));
}

/// "engram-slam, process 4711 on robot7, since 2026-11-26 19:45:02 UTC"
std::string signature() {
  char host[256] = "this machine", since[64] = "";
  gethostname(host, sizeof host - 1);
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(since, sizeof since, "%Y-%m-%d %H:%M:%S UTC", &utc);
  return std::string(program_invocation_short_name) + ", process " + std::to_string(getpid()) + " on " +
         host + ", since " + since;
}

std::string readSignature(int descriptor) {
  std::string line;
  // A holder takes the lock first and signs then.
  for (int tries = 0; line.empty() && tries < 20; ++tries) {
    if (tries > 0) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    char text[512];
    const auto n = pread(descriptor, text, sizeof text, 0);
    line.assign(text, n > 0 ? static_cast<std::size_t>(n) : 0);
    std::erase_if(line, [](unsigned char c) { return c < 0x20 || c > 0x7e; });
  }
  return line.empty() ? "another program" : line;
}

/// False when another open file holds the lock.
bool lock(int descriptor) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  return fcntl(descriptor, F_OFD_SETLK, &whole) == 0;
}

/// Whether the path still leads to this open file: its last holder may have removed it meanwhile.
bool isAt(int descriptor, const std::string& path) {
  struct stat open {
  }, there{};
  return fstat(descriptor, &open) == 0 && lstat(path.c_str(), &there) == 0 && open.st_ino == there.st_ino &&
         open.st_dev == there.st_dev;
}

std::string lockPathOf(const std::string& mapPath) {
  return fs::weakly_canonical(fs::absolute(mapPath)).string() + "-lock";
}

int lockedFile(const std::string& mapPath, const std::string& lockPath) {
  while (true) {
    const int descriptor = ::open(lockPath.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor < 0) fail(mapPath, errno);
    const bool held = !lock(descriptor);
    const int error = errno;
    if (!held && isAt(descriptor, lockPath)) return descriptor;
    const std::string holder = held ? readSignature(descriptor) : "";
    ::close(descriptor);
    if (!held) continue;
    if (error != EAGAIN && error != EACCES) fail(mapPath, error);
    throw base::Error("map '" + mapPath + "' is being written by " + holder +
                      ". Only one program may write a map: wait until it has ended");
  }
}

}  // namespace

WriterLock::WriterLock(const std::string& mapPath) : mapPath_(mapPath), lockPath_(lockPathOf(mapPath)) {
  descriptor_ = lockedFile(mapPath_, lockPath_);
  const std::string text = signature() + "\n";
  // What cannot be noted, on a full disk, only makes the message of another program poorer.
  if (ftruncate(descriptor_, 0) == 0) [[maybe_unused]]
    const auto ignored = pwrite(descriptor_, text.data(), text.size(), 0);
}

bool WriterLock::isHeld(const std::string& mapPath) {
  const int descriptor = ::open(lockPathOf(mapPath).c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return false;
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  const bool held = fcntl(descriptor, F_OFD_GETLK, &whole) == 0 && whole.l_type != F_UNLCK;
  ::close(descriptor);
  return held;
}

WriterLock::WriterLock(WriterLock&& other) noexcept
    : mapPath_(std::move(other.mapPath_)),
      lockPath_(std::move(other.lockPath_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

WriterLock& WriterLock::operator=(WriterLock&& other) noexcept {
  if (this == &other) return *this;
  release();
  mapPath_ = std::move(other.mapPath_);
  lockPath_ = std::move(other.lockPath_);
  descriptor_ = std::exchange(other.descriptor_, -1);
  return *this;
}

WriterLock::~WriterLock() { release(); }

void WriterLock::release() noexcept {
  if (descriptor_ < 0) return;
  ::unlink(lockPath_.c_str());  // while it is held: nobody else can have taken it
  ::close(std::exchange(descriptor_, -1));
}

}  // namespace engram::store
