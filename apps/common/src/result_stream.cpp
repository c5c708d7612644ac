// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/result_stream.h"

#include "engram/base/output_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <deque>
#include <fcntl.h>
#include <mutex>
#include <numbers>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace engram::apps {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxWaiting = 256 * 1024;  // [bytes] for one reader; more than a minute at 10 Hz
constexpr std::size_t kChunk =
    4096;  // a pipe that poll() calls writable takes so much without blocking (PIPE_BUF)
constexpr auto kFarewell = std::chrono::milliseconds(500);
constexpr std::size_t kMostReaders = 256;
constexpr std::size_t kOwnDescriptors = 64;  // that the run needs for map, rawlog, camera and window
constexpr auto kPause = std::chrono::milliseconds(500);  // before a reader that must wait is looked at again

[[noreturn]] void fail(const std::string& path, const std::string& what) {
  throw base::Error("--stream " + path + ": " + what);
}

/// One reader, or standard output.
struct Reader {
  int descriptor = -1;
  std::deque<std::string> lines;
  std::size_t bytes = 0;    ///< of all lines
  std::string chunk;        ///< lines on their way: as many as fit in one write, so that a socket takes many
  std::size_t written = 0;  ///< of the chunk
  bool idle() const { return lines.empty() && chunk.empty(); }
};

sockaddr_un addressOf(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) fail(path, "the path is too long for a Unix socket");
  std::memcpy(address.sun_path, path.c_str(), path.size());
  return address;
}

/// True when a program listens there.
bool answers(const sockaddr_un& address) {
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool result = ::connect(probe, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  ::close(probe);
  return result;
}

int listenAt(const std::string& path) {
  const sockaddr_un address = addressOf(path);
  struct stat status {};
  if (::lstat(path.c_str(), &status) == 0) {
    if (!S_ISSOCK(status.st_mode)) fail(path, "exists and is no socket; choose another path");
    if (answers(address)) fail(path, "another program streams there; choose another path");
    ::unlink(path.c_str());  // its program has crashed
  }
  const int listener = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (listener < 0 || ::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
      ::listen(listener, 8) != 0)
    fail(path, std::strerror(errno));
  return listener;
}

/// As many as leave the run the descriptors that it needs itself.
std::size_t readersAllowed() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return kMostReaders;
  const auto all = static_cast<std::size_t>(limit.rlim_cur);
  return std::clamp<std::size_t>(all - std::min(all, kOwnDescriptors), 1, kMostReaders);
}

}  // namespace

std::string streamLine(const types::FrameReport& report, const std::optional<StreamPose>& pose) {
  using Json = nlohmann::ordered_json;
  const auto id = [](base::PlaceId place) { return place.valid() ? Json(place.value) : Json(nullptr); };
  const auto rounded = [](double value, double perUnit) { return std::round(value * perUnit) / perUnit; };
  constexpr double kMillion = 1e6;
  Json j = {{"index", report.index},
            {"stamp", report.stamp},
            {"outcome", types::toString(report.outcome)},
            {"place", id(report.place)},
            {"best_guess", id(report.bestGuess)},
            {"pose", nullptr},
            {"belief", Json::array()},
            {"new_place", rounded(report.newPlaceProbability, kMillion)},
            {"inliers", nullptr},
            {"latency_ms", nullptr}};
  if (report.acceptedBy != types::AcceptedBy::kNothing) j["accepted_by"] = types::toString(report.acceptedBy);
  if (pose) {
    Json heading = nullptr;
    if (pose->heading) heading = rounded(*pose->heading * 180.0 / std::numbers::pi, kMillion);
    const auto metres = [&](int axis) { return rounded(pose->position[axis], kMillion); };
    j["pose"] = {{"x", metres(0)}, {"y", metres(1)}, {"z", metres(2)}};
    j["pose"]["heading_deg"] = heading;
    if (report.pose) {
      const auto sigma = [&](int i) { return std::sqrt(report.pose->T_place_robot.cov(i, i)); };
      j["pose"]["sigma_along"] = rounded(sigma(0), kMillion);
      j["pose"]["sigma_across"] = rounded(sigma(1), kMillion);
      j["pose"]["sigma_heading_deg"] = rounded(sigma(5) * 180.0 / std::numbers::pi, kMillion);
    }
  }
  int inliers = -1;
  for (const auto& h : report.hypotheses) {
    j["belief"].push_back({{"place", id(h.place)}, {"probability", rounded(h.posterior, kMillion)}});
    inliers = std::max(inliers, h.inliers);
  }
  if (inliers >= 0) j["inliers"] = inliers;
  if (report.live) j["latency_ms"] = rounded(report.live->latency, 1e3);
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

class ResultStream::Impl {
 public:
  Impl(const std::string& target, const std::string& hello) : path_(target), hello_(hello + "\n") {
    std::signal(SIGPIPE, SIG_IGN);  // a reader that has gone is found by the failing write
    wake_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
    if (target == "-")
      addReader(STDOUT_FILENO);
    else
      listener_ = listenAt(target);
    thread_ = std::thread([this] { run(); });
  }

  void finish() {
    if (!thread_.joinable()) return;
    stopping_ = true;
    wakeUp();
    thread_.join();
  }

  ~Impl() {
    finish();
    for (const auto& reader : readers_)
      if (reader.descriptor != STDOUT_FILENO) ::close(reader.descriptor);
    if (listener_ >= 0) {
      ::close(listener_);
      ::unlink(path_.c_str());
    }
    ::close(wake_);
  }

  void send(const std::string& line) {
    {
      const std::lock_guard lock(mutex_);
      for (auto& reader : readers_) enqueue(reader, line + "\n");
    }
    wakeUp();
  }

  std::size_t readers() const {
    const std::lock_guard lock(mutex_);
    return readers_.size();
  }
  std::size_t missed() const { return missed_; }
  std::size_t mostReaders() const { return mostReaders_; }
  std::size_t postponed() const { return postponed_; }
  std::string failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
  }

 private:
  void wakeUp() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto ignored = ::write(wake_, &one, sizeof one);
  }

  void addReader(int descriptor) {
    const std::lock_guard lock(mutex_);
    readers_.push_back({});
    readers_.back().descriptor = descriptor;
    enqueue(readers_.back(), hello_);
  }

  /// What does not fit is dropped, the oldest first.
  void enqueue(Reader& reader, std::string line) {
    while (reader.bytes + line.size() > kMaxWaiting && !reader.lines.empty()) {
      reader.bytes -= reader.lines.front().size();
      reader.lines.pop_front();
      ++missed_;
    }
    reader.bytes += line.size();
    reader.lines.push_back(std::move(line));
  }

  void run() {
    auto end = Clock::time_point::max();
    while (Clock::now() < end) {
      if (stopping_ && end == Clock::time_point::max()) end = Clock::now() + kFarewell;
      if (stopping_ && nothingLeft()) return;
      wait(stopping_ ? 20 : 500);
    }
  }

  bool nothingLeft() const {
    const std::lock_guard lock(mutex_);
    for (const auto& reader : readers_)
      if (!reader.idle()) return false;
    return true;
  }

  /// Waits for a new reader, a new line, or room at a reader, and serves it.
  void wait(int milliseconds) {
    std::vector<pollfd> events = {{wake_, POLLIN, 0}};
    const bool open = listener_ >= 0 && Clock::now() >= openFrom_;
    if (open) events.push_back({listener_, POLLIN, 0});
    const std::size_t first = events.size();
    {
      const std::lock_guard lock(mutex_);
      for (const auto& reader : readers_)
        events.push_back({reader.descriptor, static_cast<short>(reader.idle() ? 0 : POLLOUT), 0});
    }
    if (::poll(events.data(), events.size(), milliseconds) <= 0) return;
    std::uint64_t count = 0;
    [[maybe_unused]] const auto ignored = ::read(wake_, &count, sizeof count);
    serve({events.begin() + static_cast<std::ptrdiff_t>(first), events.end()});
    if (open && (events[1].revents & POLLIN) != 0) accept();
  }

  /// A reader for whom there is no room stays in the queue of the socket. poll() would report it without end,
  /// so the socket is left alone for a while.
  void accept() {
    int descriptor = -1;
    errno = EMFILE;
    if (readers() < mostReaders_)
      descriptor = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (descriptor >= 0) return addReader(descriptor);
    if (errno == EAGAIN || errno == EINTR || errno == ECONNABORTED) return;
    ++postponed_;
    openFrom_ = Clock::now() + kPause;
  }

  void serve(const std::vector<pollfd>& events) {
    const std::lock_guard lock(mutex_);
    for (const auto& event : events) {
      const auto reader = std::find_if(readers_.begin(), readers_.end(),
                                       [&](const Reader& r) { return r.descriptor == event.fd; });
      const bool gone = (event.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0;
      if (!gone && ((event.revents & POLLOUT) == 0 || writeTo(*reader))) continue;
      if (reader->descriptor != STDOUT_FILENO) ::close(reader->descriptor);
      readers_.erase(reader);
    }
  }

  /// False when the reader has gone.
  bool writeTo(Reader& reader) {
    while (!reader.lines.empty() &&
           (reader.chunk.empty() || reader.chunk.size() + reader.lines.front().size() <= kChunk) &&
           reader.written == 0) {
      reader.chunk += reader.lines.front();
      reader.bytes -= reader.lines.front().size();
      reader.lines.pop_front();
    }
    const std::size_t n = std::min(kChunk, reader.chunk.size() - reader.written);
    const auto done = ::write(reader.descriptor, reader.chunk.data() + reader.written, n);
    if (done < 0 && reader.descriptor == STDOUT_FILENO && errno != EPIPE && errno != EAGAIN && errno != EINTR)
      failure_ = base::reasonOf(errno);
    if (done < 0) return errno == EAGAIN || errno == EINTR;
    reader.written += static_cast<std::size_t>(done);
    if (reader.written < reader.chunk.size()) return true;
    reader.chunk.clear();
    reader.written = 0;
    return true;
  }

  std::string path_, hello_;
  const std::size_t mostReaders_ = readersAllowed();
  int listener_ = -1, wake_ = -1;
  Clock::time_point openFrom_ = Clock::time_point::min();  // no new reader before
  mutable std::mutex mutex_;
  std::vector<Reader> readers_;  // under mutex_
  std::string failure_;          // likewise
  std::atomic<std::size_t> missed_{0}, postponed_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

ResultStream::ResultStream(const std::string& target, const std::string& hello)
    : impl_(std::make_unique<Impl>(target, hello)) {}
ResultStream::~ResultStream() = default;
void ResultStream::finish() { impl_->finish(); }
void ResultStream::send(const std::string& line) { impl_->send(line); }
std::size_t ResultStream::readers() const { return impl_->readers(); }
std::size_t ResultStream::missed() const { return impl_->missed(); }
std::size_t ResultStream::mostReaders() const { return impl_->mostReaders(); }
std::size_t ResultStream::postponed() const { return impl_->postponed(); }
std::string ResultStream::failure() const { return impl_->failure(); }

}  // namespace engram::apps
