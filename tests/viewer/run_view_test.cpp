// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The window itself, on a virtual screen.
#include "engram/viewer/run_view.h"

#include "camera_process.h"
#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <thread>

namespace engram::viewer {
namespace {

using ::testing::HasSubstr;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

/// A virtual screen of our own, on a number that is free.
class VirtualScreen {
 public:
  VirtualScreen() {
    int ready[2];
    if (pipe(ready) != 0) return;
    server_ = std::make_unique<engram::testing::ChildProcess>(std::vector<std::string>{
        "Xvfb", "-displayfd", std::to_string(ready[1]), "-screen", "0", "1400x900x24", "-nolisten", "tcp"});
    close(ready[1]);
    char number[16] = {};
    const auto n = read(ready[0], number, sizeof number - 1);
    close(ready[0]);
    std::string display = ":";
    display += std::to_string(n > 0 ? std::atoi(number) : 0);
    setenv("DISPLAY", display.c_str(), 1);
  }
  ~VirtualScreen() { unsetenv("DISPLAY"); }

 private:
  std::unique_ptr<engram::testing::ChildProcess> server_;
};

map::TopologicalMap smallMap() {
  map::TopologicalMap map;
  for (int i = 0; i < 5; ++i) {
    map::Place place;
    place.T_map_place.translation().x() = 0.8 * i;
    const auto id = map.addPlace(std::move(place));
    map::View view;
    view.place = id;
    map.addView(std::move(view));
  }
  return map;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_L1) == 0.0;
}

TEST(RunView, SaysThatThereIsNoDisplay) {
  const char* display = std::getenv("DISPLAY");
  const std::string before = display ? display : "";
  const auto refusal = []() -> std::string {
    try {
      const RunView view({}, "test");
    } catch (const base::Error& e) {
      return e.what();
    }
    return "opened";
  };
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  EXPECT_THAT(refusal(), HasSubstr("DISPLAY is not set"));
  setenv("DISPLAY", ":4711", 1);
  EXPECT_THAT(refusal(), HasSubstr("DISPLAY is ':4711'"));
  if (display)
    setenv("DISPLAY", before.c_str(), 1);
  else
    unsetenv("DISPLAY");
}

TEST(RunView, ShowsARunOnAVirtualScreen) {
  const VirtualScreen screen;
  const std::string picture =
      (fs::temp_directory_path() / ("engram_view_" + std::to_string(getpid()) + ".png")).string();
  const map::TopologicalMap map = smallMap();
  types::FrameReport report;
  report.outcome = types::Outcome::kRecognised;
  report.place = report.bestGuess = base::PlaceId(2);
  report.hypotheses = {{base::PlaceId(2), 0.9, 0.9, 50}};
  types::Frame frame;
  frame.image = cv::Mat(240, 320, CV_8UC1);
  cv::RNG(1).fill(frame.image, cv::RNG::UNIFORM, 0, 256);
  cv::Mat panel, later;
  {
    RunView view({}, "test");
    // Shows it until what is saved satisfies `done`.
    const auto showUntil = [&](const std::function<bool(const cv::Mat&)>& done) {
      const auto end = std::chrono::steady_clock::now() + 20s;
      cv::Mat saved;
      while (!done(saved) && std::chrono::steady_clock::now() < end) {
        view.show(frame, report, map);
        EXPECT_EQ(view.wish([] { return false; }), RunView::Wish::kGoOn);  // nobody has pressed a button
        view.savePicture(picture);                                         // once one was drawn
        if (fs::exists(picture)) saved = cv::imread(picture);
        std::this_thread::sleep_for(20ms);
      }
      return saved;
    };
    panel = showUntil([](const cv::Mat& saved) { return !saved.empty(); });
    report = {};  // an image that was passed over
    report.index = 7;
    report.outcome = types::Outcome::kSkipped;
    later = showUntil([&](const cv::Mat& saved) { return !saved.empty() && !same(saved, panel); });
    report.index = 8;
    report.outcome = types::Outcome::kNewPlace;
    report.place = base::PlaceId(77);  // upkeep has taken it out again
    const cv::Mat gone =
        showUntil([&](const cv::Mat& saved) { return !saved.empty() && !same(saved, later); });
    EXPECT_EQ(gone.at<cv::Vec3b>(10, 320), cv::Vec3b(190, 120, 30));  // new place
    EXPECT_FALSE(view.closed());
  }
  fs::remove(picture);
  ASSERT_FALSE(panel.empty());
  EXPECT_EQ(panel.at<cv::Vec3b>(10, 320), cv::Vec3b(70, 170, 70));  // tracking
  // What was known stays in the picture: only the number of the image is another.
  EXPECT_FALSE(same(later, panel));
  const auto withoutNumber = [](const cv::Mat& p) { return p.rowRange(38, p.rows); };
  EXPECT_TRUE(same(withoutNumber(later), withoutNumber(panel)));
  EXPECT_EQ(later.at<cv::Vec3b>(10, 320), cv::Vec3b(70, 170, 70));
}

}  // namespace
}  // namespace engram::viewer
