// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_command.h"
#include "engram/apps/checks.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/capture/fake_server.h"
#include "engram/sources/rawlog_source.h"

#include <atomic>
#include <chrono>
#include <ostream>
#include <thread>

namespace engram::apps {
namespace {

class ServeCommand final : public Program {
 public:
  std::string name() const override { return "serve"; }
  std::string description() const override {
    return "Plays the images of a rawlog as a simulated GigE Vision camera, to try live work without one";
  }
  std::string examples() const override { return "  engram-capture serve walk.rawlog --rate 10\n"; }
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  cv::Mat nextImage();

  std::string path_;
  capture::FakeServerParams params_;
  double seconds_ = 0.0;
  bool loop_ = false, quiet_ = false;

  std::unique_ptr<sources::RawlogSource> source_;
  cv::Mat first_;  // until it was shown
  cv::Size size_;
  int type_ = 0;
  std::atomic<bool> ended_{false};
};

void ServeCommand::declare(CLI::App& app) {
  app.add_option("rawlog", path_, "Rawlog with the images")->required()->type_name("FILE");
  app.add_option("--interface", params_.interface, "Network interface, by name or address")
      ->capture_default_str();
  app.add_option("--serial", params_.serial, "Serial number; the id is Aravis-Fake-SERIAL")
      ->capture_default_str();
  app.add_option("--rate", params_.rate, "Images per second, unless the client sets frame_rate")
      ->check(between(0.1, 1000))
      ->capture_default_str();
  app.add_option("--loss", params_.loss, "Share of the network packets that are not sent")
      ->check(between(0, 1));
  app.add_option("--seconds", seconds_, "Stop after so long; default: 2 s after the last image")
      ->check(positive());
  app.add_flag("--loop", loop_, "Begin again at the end");
  app.add_flag("-q,--quiet", quiet_, "No progress on the terminal");
}

/// In the thread of the camera: images begin when a client asks for them.
cv::Mat ServeCommand::nextImage() {
  if (!first_.empty()) return std::exchange(first_, cv::Mat());
  for (int attempt = 0; attempt < 2; ++attempt) {
    while (auto frame = source_->next())
      if (frame->image.size() == size_ && frame->image.type() == type_) return frame->image;
    if (!loop_) break;
    source_ = sources::openRawlog(path_);
  }
  ended_ = true;
  return {};
}

int ServeCommand::run(std::ostream& out, std::ostream& err) {
  using Clock = std::chrono::steady_clock;
  source_ = sources::openRawlog(path_);
  auto frame = source_->next();
  if (!frame) throw base::Error(source_->problem().empty() ? path_ + " holds no images" : source_->problem());
  first_ = frame->image;
  size_ = first_.size();
  type_ = first_.type();
  const capture::FakeServer server(params_, first_, [this] { return nextImage(); });
  out << "Aravis-Fake-" << params_.serial << " at " << params_.interface << ", " << size_.width << "x"
      << size_.height << ", " << params_.rate << " images/s; Ctrl-C ends it\n"
      << std::flush;
  base::Progress progress(quiet_ ? nullptr : &err, "serving");
  const auto start = Clock::now();
  auto end = Clock::time_point::max();
  if (seconds_ > 0)
    end = start + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds_));
  while (!base::interrupted() && Clock::now() < end) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    progress.update(-1.0, server.sent());
    if (ended_ && seconds_ == 0 && end == Clock::time_point::max())
      end = Clock::now() + std::chrono::seconds(2);
  }
  return kOk;
}

}  // namespace

std::unique_ptr<Program> makeServeCommand() { return std::make_unique<ServeCommand>(); }

}  // namespace engram::apps
