// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/viewer/run_view.h"

#include "annotator.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/map/picture.h"
#include "map_scene.h"
#include "snapshot.h"

#include <mrpt/gui/CDisplayWindowGUI.h>
#include <opencv2/imgcodecs.hpp>

#include <GLFW/glfw3.h>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace engram::viewer {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int kWidth = 1280, kHeight = 760, kPanelWidth = 640;  // [px]
constexpr auto kInterval = 250ms;                               // between pictures
constexpr int kIdleMs =
    120;  // between drawings of the window, which cost more than the pictures without a GPU

}  // namespace

class RunView::Impl {
 public:
  Impl(const pipeline::PipelineParams& params, const std::string& title) : params_(params), title_(title) {
    if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY"))
      throw base::Error(
          "--view needs a display, and DISPLAY is not set; without a screen: xvfb-run -a COMMAND");
    thread_ = std::thread([this] { run(); });
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return started_ || !failure_.empty(); });
    if (failure_.empty()) return;
    lock.unlock();
    thread_.join();
    throw base::Error("--view: " + failure_);
  }

  ~Impl() {
    leaving_ = true;
    wakeUntilItEnds();
    if (thread_.joinable()) thread_.join();
  }

  void show(const types::Frame& frame, const types::FrameReport& report, const map::TopologicalMap& map) {
    state_ = stateAfter(report, state_);
    if (report.outcome != types::Outcome::kSkipped) known_ = report;
    if (closed_ || (!wanted_ && !paused_)) return;
    known_.index = report.index;
    Snapshot snapshot = snapper_.take(frame, known_, state_, map);
    const std::lock_guard lock(mutex_);
    pending_ = std::move(snapshot);
    wanted_ = false;
  }

  Wish wish(const std::function<bool()>& stopped) {
    std::unique_lock lock(mutex_);
    while (paused_ && !step_ && !save_ && !closed_ && !stopped()) changed_.wait_for(lock, 50ms);
    if (std::exchange(save_, false)) return Wish::kSave;
    step_ = false;
    return Wish::kGoOn;
  }

  void savePicture(const std::string& path) const {
    const std::lock_guard lock(mutex_);
    if (panel_.empty()) return;
    std::vector<unsigned char> png;
    cv::imencode(".png", panel_, png);
    base::writeText(path, {reinterpret_cast<const char*>(png.data()), png.size()}, true);
  }

  bool closed() const { return closed_; }

 private:
  /// The loop of nanogui now and then loses the event that would end its sleep.
  void wakeUntilItEnds() {
    while (true) {
      {
        const std::lock_guard lock(mutex_);
        if (!looping_) return;
        glfwPostEmptyEvent();
      }
      std::this_thread::sleep_for(20ms);
    }
  }

  void run() {
    try {
      nanogui::init();
      {
        mrpt::gui::CDisplayWindowGUI window(title_, kWidth, kHeight);
        fill(window);
        {
          const std::lock_guard lock(mutex_);
          started_ = looping_ = true;
        }
        changed_.notify_all();
        nanogui::mainloop(kIdleMs, kIdleMs);
        const std::lock_guard lock(mutex_);
        looping_ = false;
      }
      nanogui::shutdown();
    } catch (const std::exception& e) {
      const std::lock_guard lock(mutex_);
      looping_ = false;
      failure_ = std::string(e.what()) + " (DISPLAY is '" +
                 (std::getenv("DISPLAY") ? std::getenv("DISPLAY") : "") +
                 "'); without a screen: xvfb-run -a COMMAND";
    }
    closed_ = true;
    changed_.notify_all();
  }

  void fill(mrpt::gui::CDisplayWindowGUI& window) {
    scene_.emplace(1.0 - 1.0 * kPanelWidth / kWidth);
    window.background_scene = scene_->scene();
    window.camera().setElevationDegrees(65.0f);
    window.camera().setAzimuthDegrees(-90.0f);
    auto* box = new nanogui::Window(&window, "Run");  // owned by its parent
    box->setPosition({8, 8});
    box->setLayout(
        new nanogui::BoxLayout(nanogui::Orientation::Horizontal, nanogui::Alignment::Middle, 6, 6));
    const auto button = [&](const std::string& text, const std::function<void()>& action) {
      auto* b = new nanogui::Button(box, text);
      b->setCallback(action);
      return b;
    };
    pauseButton_ = button("Pause", [this] { togglePause(); });
    button("Step", [this] { step(); });
    button("Save", [this] { requestSave(); });
    window.addKeyboardCallback([this](int key, int, int action, int) { return onKey(key, action); });
    window.addLoopCallback([this, &window] { tick(window); });
    window.performLayout();
    window.drawAll();
    window.setVisible(true);
  }

  bool onKey(int key, int action) {
    if (action != GLFW_PRESS) return false;
    switch (key) {
      case GLFW_KEY_SPACE:
        togglePause();
        return true;
      case GLFW_KEY_N:
      case GLFW_KEY_RIGHT:
        step();
        return true;
      case GLFW_KEY_S:
        requestSave();
        return true;
      default:
        return false;
    }
  }

  void togglePause() {
    paused_ = !paused_;
    pauseButton_->setCaption(paused_ ? "Go on" : "Pause");
    changed_.notify_all();
  }
  void step() {
    if (!paused_) togglePause();
    const std::lock_guard lock(mutex_);
    step_ = true;
    changed_.notify_all();
  }
  void requestSave() {
    const std::lock_guard lock(mutex_);
    save_ = true;
    changed_.notify_all();
  }

  /// In the thread of the window, some ten times a second.
  void tick(mrpt::gui::CDisplayWindowGUI& window) {
    if (leaving_) return nanogui::leave();
    std::optional<Snapshot> snapshot;
    {
      const std::lock_guard lock(mutex_);
      snapshot.swap(pending_);
    }
    if (snapshot) draw(*snapshot, window);
    if (!wanted_ && Clock::now() - lastDrawn_ >= kInterval) wanted_ = true;
  }

  void draw(const Snapshot& snapshot, mrpt::gui::CDisplayWindowGUI& window) {
    lastDrawn_ = Clock::now();
    if (!annotator_) annotator_.emplace(params_);
    PanelContent content;
    content.image = snapshot.image;
    content.marks = annotator_->marks(snapshot);
    if (map::brokenPicture(snapshot.matchedJpeg).empty())
      content.matched = cv::imdecode(snapshot.matchedJpeg, cv::IMREAD_COLOR);
    content.state = snapshot.state;
    content.report = snapshot.report;
    content.places = snapshot.map.places.size();
    cv::Mat panel = drawPanel(content, {kPanelWidth, kHeight});
    const std::lock_guard sceneLock(window.background_scene_mtx);
    scene_->show(snapshot.map);
    scene_->showPanel(panel);
    pointCamera(window);
    const std::lock_guard lock(mutex_);
    panel_ = panel;
  }

  /// Shows the whole map when it has grown; leaves the rest to the user's mouse.
  void pointCamera(mrpt::gui::CDisplayWindowGUI& window) {
    if (scene_->extent() < 1.05f * shownExtent_) return;
    shownExtent_ = scene_->extent();
    const Eigen::Vector3f centre = scene_->centre();
    window.camera().setCameraPointing(centre.x(), centre.y(), centre.z());
    window.camera().setZoomDistance(2.1f * shownExtent_);
  }

  const pipeline::PipelineParams params_;
  const std::string title_;
  // In the thread of the run.
  Snapper snapper_;
  RobotState state_ = RobotState::kBlind;
  types::FrameReport known_;  // of the last image that was not skipped
  // In the thread of the window.
  std::optional<MapScene> scene_;
  std::optional<Annotator> annotator_;
  nanogui::Button* pauseButton_ = nullptr;
  Clock::time_point lastDrawn_;
  float shownExtent_ = 0.0f;
  // Between both.
  std::atomic<bool> wanted_{true}, paused_{false}, closed_{false}, leaving_{false};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool started_ = false, looping_ = false, step_ = false, save_ = false;  // under mutex_, as those below
  std::string failure_;
  std::optional<Snapshot> pending_;
  cv::Mat panel_;
  std::thread thread_;
};

RunView::RunView(const pipeline::PipelineParams& params, const std::string& title)
    : impl_(std::make_unique<Impl>(params, title)) {}
RunView::~RunView() = default;
void RunView::show(const types::Frame& frame, const types::FrameReport& report,
                   const map::TopologicalMap& map) {
  impl_->show(frame, report, map);
}
RunView::Wish RunView::wish(const std::function<bool()>& stopped) { return impl_->wish(stopped); }
void RunView::savePicture(const std::string& path) const { impl_->savePicture(path); }
bool RunView::closed() const { return impl_->closed(); }

}  // namespace engram::viewer
