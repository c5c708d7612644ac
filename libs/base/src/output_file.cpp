// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/output_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <optional>
#include <poll.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

namespace engram::base {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // as the kernel's
constexpr std::size_t kMaxName = 255;

[[noreturn]] void cannotWrite(const std::string& path, const std::string& reason) {
  throw Error("cannot write '" + path + "': " + reason);
}

/// What a path names.
struct Target {
  std::string file;            ///< the regular file, without links; empty: written through
  std::optional<mode_t> mode;  ///< of the file that is there
  int standard = -1;           ///< the descriptor that goes to this file already
  bool isNew() const { return !file.empty() && !mode; }
};

fs::path folderOf(const fs::path& path) {
  const fs::path folder = path.parent_path();
  return folder.empty() ? fs::path(".") : folder;
}

/// In a folder of all, such as /tmp, a link of somebody else is a trap.
void refusePlantedLink(const fs::path& link, const struct stat& status, const std::string& path) {
  struct stat folder {};
  if (::stat(folderOf(link).c_str(), &folder) != 0) return;
  constexpr mode_t kOfAll = S_ISVTX | S_IWOTH;
  if ((folder.st_mode & kOfAll) == kOfAll && status.st_uid != ::geteuid() && status.st_uid != folder.st_uid)
    cannotWrite(path, "'" + link.string() + "' is a link that another user has put into a folder of all");
}

/// The path at the end of a chain of links, whether there is something or not.
std::string followLinks(const std::string& path) {
  fs::path at = path;
  for (int i = 0; i < kMaxLinks; ++i) {
    struct stat status {};
    if (::lstat(at.c_str(), &status) != 0 || !S_ISLNK(status.st_mode)) return at.string();
    refusePlantedLink(at, status, path);
    std::error_code error;
    const fs::path to = fs::read_symlink(at, error);
    if (error) cannotWrite(path, error.message());
    at = to.is_absolute() ? to : at.parent_path() / to;
  }
  cannotWrite(path, std::strerror(ELOOP));
}

bool isSameFile(const struct stat& a, const struct stat& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

void requireFolder(const std::string& path, const fs::path& file) {
  const fs::path folder = fs::absolute(file).parent_path();
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    cannotWrite(path, "folder '" + folder.string() + "' does not exist");
}

Target newTarget(const std::string& path) {
  const std::string file = followLinks(path);
  requireFolder(path, file);
  return {file, std::nullopt, -1};
}

Target targetOf(const std::string& path, bool overwrite) {
  if (path.empty()) throw Error("the output needs a file name");
  if (path == kStandardOutput) return {"", std::nullopt, STDOUT_FILENO};
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno != ENOENT) cannotWrite(path, std::strerror(errno));
    return newTarget(path);
  }
  if (S_ISDIR(status.st_mode)) cannotWrite(path, "it is a folder");
  if (S_ISSOCK(status.st_mode)) cannotWrite(path, "it is a socket");
  if (S_ISBLK(status.st_mode)) cannotWrite(path, "it is a disk");
  if (!S_ISREG(status.st_mode)) return {};
  for (const int standard : {STDOUT_FILENO, STDERR_FILENO})
    if (struct stat own{}; ::fstat(standard, &own) == 0 && isSameFile(own, status))
      return {"", std::nullopt, standard};
  if (!overwrite) throw Error("'" + path + "' exists already. Allow overwriting, or choose another name");
  Target target{followLinks(path), status.st_mode, -1};
  struct stat end {};
  if (::stat(target.file.c_str(), &end) != 0 || !isSameFile(end, status))
    cannotWrite(path, "its link leads nowhere");
  return target;
}

/// The last bytes of the name stay, as some writers choose the format by its ending.
std::string temporaryName(const std::string& path) {
  unsigned char noise[8];
  if (::getrandom(noise, sizeof noise, 0) != sizeof noise) cannotWrite(path, std::strerror(errno));
  std::string name = ".partial-";
  for (const unsigned char byte : noise) {
    char hex[3];
    std::snprintf(hex, sizeof hex, "%02x", byte);
    name += hex;
  }
  name += '-';
  const std::string end = fs::path(path).filename().string();
  const std::size_t room = kMaxName - name.size();
  return name + (end.size() > room ? end.substr(end.size() - room) : end);
}

constexpr int kNewFile = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;

/// Makes the temporary file; its name goes to `name`.
int createBeside(const std::string& path, const std::string& file, std::string& name) {
  if (fs::path(file).filename().string().size() > kMaxName) cannotWrite(path, std::strerror(ENAMETOOLONG));
  name = temporaryBeside(file);
  const int descriptor = ::open(name.c_str(), kNewFile, 0666);
  if (descriptor < 0) cannotWrite(path, reasonOf(errno));
  return descriptor;
}

int openThrough(const std::string& path, const Target& target) {
  const int descriptor = target.standard >= 0 ? ::fcntl(target.standard, F_DUPFD_CLOEXEC, STDERR_FILENO + 1)
                                              : ::open(path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
  if (descriptor < 0) cannotWrite(path, reasonOf(errno));
  return descriptor;
}

/// Whatever the umask says, a file does not become more open by being replaced.
void keepMode(int descriptor, mode_t earlier) {
  struct stat status {};
  if (::fstat(descriptor, &status) == 0) [[maybe_unused]]
    const int ignored = ::fchmod(descriptor, status.st_mode & earlier & 0777);
}

}  // namespace

std::string reasonOf(int errorNumber) {
  std::string reason = std::strerror(errorNumber != 0 ? errorNumber : EIO);
  if (errorNumber == ENOSPC || errorNumber == EFBIG || errorNumber == EDQUOT)
    reason += "; free some space or choose another disk";
  return reason;
}

int writeAll(int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::write(descriptor, bytes.data(), bytes.size());
    if (n >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(n));
    } else if (errno == EAGAIN) {  // somebody who shares the pipe does not wait
      pollfd room{descriptor, POLLOUT, 0};
      ::poll(&room, 1, -1);
    } else if (errno != EINTR) {
      return errno;
    }
  }
  return 0;
}

int syncFile(int descriptor) {
  if (::fsync(descriptor) == 0) return 0;
  const bool hasNoDisk = errno == EINVAL || errno == ENOTSUP || errno == EROFS;
  return hasNoDisk ? 0 : errno;
}

void syncFolderOf(const std::string& path) {
  const int folder = ::open(folderOf(path).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;  // a folder that may be written but not read
  const int error = syncFile(folder);
  ::close(folder);
  if (error != 0) cannotWrite(path, reasonOf(error));
}

void syncDisk(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const int error = descriptor >= 0 && ::syncfs(descriptor) == 0 ? 0 : errno;
  if (descriptor >= 0) ::close(descriptor);
  if (error != 0) cannotWrite(path, reasonOf(error));
}

std::string temporaryBeside(const std::string& path) {
  return (fs::path(path).parent_path() / temporaryName(path)).string();
}

void requireWritable(const std::string& path, bool overwrite) {
  if (path.empty()) return;
  const Target target = targetOf(path, overwrite);
  if (target.standard >= 0) {
    const int flags = ::fcntl(target.standard, F_GETFL);
    if (flags < 0 || (flags & O_ACCMODE) == O_RDONLY) cannotWrite(path, "standard output is closed");
    return;
  }
  if (!target.isNew() && ::access(path.c_str(), W_OK) != 0) cannotWrite(path, reasonOf(errno));
  if (target.file.empty()) return;
  std::string name;
  ::close(createBeside(path, target.file, name));
  ::unlink(name.c_str());
}

void requireWritableFolder(const std::string& folder) {
  std::string name;
  const std::string inside = (fs::path(folder) / "x").string();
  requireFolder(folder, inside);
  ::close(createBeside(folder, inside, name));
  ::unlink(name.c_str());
}

bool isRegularOutput(const std::string& path) { return !targetOf(path, true).file.empty(); }

int openOutput(const std::string& path, bool overwrite) {
  const Target target = targetOf(path, overwrite);
  if (target.file.empty()) return openThrough(path, target);
  const int flags = target.isNew() ? kNewFile : O_WRONLY | O_TRUNC | O_NOFOLLOW | O_CLOEXEC;
  const int descriptor = ::open(target.file.c_str(), flags, 0666);
  if (descriptor < 0) cannotWrite(path, reasonOf(errno));
  return descriptor;
}

OutputFile::OutputFile(std::string path, bool overwrite) : path_(std::move(path)), overwrite_(overwrite) {
  const Target target = targetOf(path_, overwrite);
  target_ = target.file;
  if (target_.empty()) {
    descriptor_ = openThrough(path_, target);
    return;
  }
  if (target.mode && ::access(target_.c_str(), W_OK) != 0) cannotWrite(path_, reasonOf(errno));
  descriptor_ = createBeside(path_, target_, temporary_);
  if (target.mode) keepMode(descriptor_, *target.mode);
}

OutputFile::~OutputFile() {
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  if (descriptor_ >= 0) ::close(descriptor_);
}

void OutputFile::write(std::string_view bytes) {
  const int error = writeAll(descriptor_, bytes);
  if (error == EPIPE && path_ == kStandardOutput) throw ClosedPipe();
  if (error != 0) cannotWrite(path_, reasonOf(error));
}

void OutputFile::commit(Sync sync) {
  if (sync == Sync::kNow)
    if (const int error = syncFile(descriptor_); error != 0) cannotWrite(path_, reasonOf(error));
  const int descriptor = descriptor_;
  descriptor_ = -1;
  if (::close(descriptor) != 0 && errno != EINTR) cannotWrite(path_, reasonOf(errno));  // NFS tells here
  if (temporary_.empty()) return;
  giveName();
  if (sync == Sync::kNow) syncFolderOf(target_);
}

/// What has come up at the name meanwhile is not replaced unless it may be.
void OutputFile::giveName() {
  struct stat status {};
  const bool there = ::lstat(target_.c_str(), &status) == 0;
  if (there && !S_ISREG(status.st_mode)) cannotWrite(path_, "it is no longer a regular file");
  int error = 0;
  if (overwrite_) {
    error = ::rename(temporary_.c_str(), target_.c_str()) == 0 ? 0 : errno;
  } else {
    error = ::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, target_.c_str(), RENAME_NOREPLACE) == 0
                ? 0
                : errno;
    if (error == EINVAL && !there)  // a file system that does not know the flag
      error = ::rename(temporary_.c_str(), target_.c_str()) == 0 ? 0 : errno;
  }
  if (error != 0) cannotWrite(path_, reasonOf(error));
  temporary_.clear();
}

}  // namespace engram::base
