// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_command.h"
#include "engram/apps/checks.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/capture/bounded_queue.h"
#include "engram/capture/gige_grabber.h"
#include "engram/types/frame.h"

#include <mrpt/gui/CDisplayWindow.h>
#include <opencv2/core.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ostream>

namespace engram::apps {
namespace {

using Clock = std::chrono::steady_clock;

class PreviewCommand final : public Program {
 public:
  std::string name() const override { return "preview"; }
  std::string description() const override {
    return "Shows what a camera sees, with rate and losses, in a window";
  }
  std::string examples() const override { return "  engram-capture preview --camera 192.168.5.10\n"; }
  void declare(CLI::App& app) override {
    camera_.declare(app);
    app.add_option("--seconds", seconds_, "Stop after so long; default: when the window is closed")
        ->check(positive());
  }
  int run(std::ostream& out, std::ostream& err) override;

 private:
  CameraOptions camera_;
  double seconds_ = 0.0;
};

/// One pair beside the other.
cv::Mat sideBySide(const types::Frame& frame) {
  if (frame.right.empty() || frame.right.size() != frame.image.size() ||
      frame.right.type() != frame.image.type())
    return frame.image;
  cv::Mat both;
  cv::hconcat(frame.image, frame.right, both);
  return both;
}

std::string title(const capture::GrabStats& stats, double rate) {
  char text[160];
  std::snprintf(text, sizeof text, "%s: %.1f images/s, %zu received, %zu lost",
                stats.cameras[0].settings.id.c_str(), rate, stats.frames, stats.lost());
  return text;
}

int PreviewCommand::run(std::ostream&, std::ostream& err) {
  if (!std::getenv("DISPLAY"))
    throw base::Error(
        "preview needs a display, and DISPLAY is not set; without a screen: xvfb-run -a COMMAND");
  const capture::LiveConfig live = camera_.load();
  capture::BoundedQueue<types::Frame> queue(1, capture::WhenFull::kDropOldest);
  capture::GigeGrabber grabber(live.camera, [&queue](types::Frame&& frame) { queue.push(std::move(frame)); });
  mrpt::gui::CDisplayWindow window("engram-capture", 640, 480);

  const auto start = Clock::now();
  auto lastTitle = start;
  std::size_t framesThen = 0;
  const auto since = [](Clock::time_point then) {
    return std::chrono::duration<double>(Clock::now() - then).count();
  };
  while (window.isOpen() && !base::interrupted() && grabber.failure().empty() &&
         (seconds_ == 0 || since(start) < seconds_)) {
    if (const auto frame = queue.pop(std::chrono::milliseconds(100)))
      window.showImage(mrpt::img::CImage(sideBySide(*frame), mrpt::img::DEEP_COPY));
    for (const auto& notice : grabber.takeNotices())
      err << "engram-capture: " << notice << "\n" << std::flush;
    if (since(lastTitle) < 1.0) continue;
    const auto stats = grabber.stats();
    window.setWindowTitle(title(stats, static_cast<double>(stats.frames - framesThen) / since(lastTitle)));
    framesThen = stats.frames;
    lastTitle = Clock::now();
  }
  grabber.stop();
  if (grabber.failure().empty()) return kOk;
  throw base::Error(grabber.failure());
}

}  // namespace

std::unique_ptr<Program> makePreviewCommand() { return std::make_unique<PreviewCommand>(); }

}  // namespace engram::apps
