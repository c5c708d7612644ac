// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/run_use.h"

#include "engram/base/error.h"
#include "engram/base/text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <vector>

namespace engram::apps {
namespace {

constexpr int kCertain = 8;        // pairs looked at for which a fault of the eyes must stand
constexpr std::size_t kNamed = 3;  // causes in the summary

/// What to do, by the beginning of the cause.
const std::vector<std::pair<const char*, const char*>> kAdvice{
    {"the right image of the stereo camera is missing",
     "record both eyes as pairs, or name the right camera with [source] right_label; for a single camera "
     "take "
     "a configuration without [camera] stereo"},
    {"the right image is", "let both eyes give images of one size"},
    {"the image is", "set [camera] file to the calibration of this camera, made for images of this size"},
    {"too few features", "is the lens covered, the image sharp and bright? see [extractor]"},
    {"visual odometry failed",
     "is the calibration that of this camera, are the images bright, and frequent for the speed of the "
     "robot? "
     "`engram-rawlog info` checks the eyes"},
    {"the first image", "a map of views needs images of a robot that moves"},
    {"the graph refuses", "is the odometry sound, in scale and in direction?"},
    {"not localised in the map yet",
     "was the map made here, with this camera? drive through places that it knows"},
    {"no place is probable enough",
     "was the map made here, with this camera, in such light? --extend teaches it"},
    {"the geometry does not confirm", "was the map made here, with this camera? --extend teaches it"},
};
const char* const kElse = "images.jsonl in the folder of --report says more of each image";

std::string adviceFor(const std::string& cause) {
  for (const auto& [beginning, advice] : kAdvice)
    if (cause.starts_with(beginning)) return advice;
  return kElse;
}

/// The largest count first.
std::vector<std::pair<std::string, int>> ordered(const std::map<std::string, int>& counts) {
  std::vector<std::pair<std::string, int>> list(counts.begin(), counts.end());
  std::stable_sort(list.begin(), list.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return list;
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

/// "the graph refuses the closure to place 17: …" is one cause for all places. What follows a colon is a
/// particular of one image (visual odometry fails in five ways by one wrong calibration); the records have
/// it.
std::string causeIn(const std::string& reason) {
  std::string cause = reason.substr(0, reason.find_first_of(":;"));
  const std::string word = " place ";
  for (auto at = cause.find(word); at != std::string::npos; at = cause.find(word, at + 1)) {
    const auto number = at + word.size();
    auto end = number;
    while (end < cause.size() && isDigit(cause[end])) ++end;
    if (end > number) cause.replace(at, end - at, " a place");
  }
  return cause.empty() ? "no reason given" : cause;
}

void RunUse::add(const types::FrameReport& report) {
  using types::Outcome;
  ++images_;
  if (report.outcome == Outcome::kSkipped) return void(++skipped_[causeIn(report.reason)]);
  used_ += report.outcome != Outcome::kUnusable;
  placed_ += report.outcome == Outcome::kNewPlace || report.outcome == Outcome::kRecognised;
  if (report.outcome == Outcome::kUnusable || report.outcome == Outcome::kRefused)
    ++causes_[causeIn(report.reason)];
  if (report.outcome == Outcome::kRefused) ++refused_[causeIn(report.reason)];
}

std::string RunUse::complaint() const {
  Counts causes = none() && causes_.empty() ? skipped_ : causes_;
  if (placed_ > 0)
    for (const auto& [cause, count] : refused_) causes[cause] -= count;
  const auto list = ordered(causes);
  if (list.empty() || (!none() && 2 * list.front().second <= images_)) return {};
  const auto& [cause, count] = list.front();
  const std::string what =
      none() ? "none of " + base::counted(static_cast<std::size_t>(images_), "image") +
                   " could be used; the cause of " + std::to_string(count) + ": "
             : std::to_string(count) + " of " + std::to_string(images_) + " images were of no use: ";
  return what + cause + "; " + adviceFor(cause);
}

void RunUse::requireSome() const {
  if (none()) throw base::Error(complaint());
}

std::string RunUse::summary() const {
  if (causes_.empty()) return {};
  std::string text = "  of no use:";
  std::size_t named = 0;
  int left = 0;
  for (const auto& [cause, count] : ordered(causes_)) {
    if (named++ < kNamed)
      text += (named > 1 ? ", " : " ") + std::to_string(count) + " (" + cause + ")";
    else
      left += count;
  }
  return text + (left > 0 ? ", " + std::to_string(left) + " for other causes" : "") + "\n";
}

nlohmann::json RunUse::toJson() const {
  nlohmann::json json = nlohmann::json::object();
  for (const auto& [cause, count] : causes_) json[cause] = count;
  return json;
}

nlohmann::json toJson(const pipeline::OdometryHealth& health) {
  if (health.steps == 0) return nullptr;
  const auto ifAny = [](int count, double value) { return count > 0 ? nlohmann::json(value) : nullptr; };
  const std::string fault = describe(health);
  return {{"steps", health.steps},
          {"leaps", health.leaps},
          {"fastest_m_s", health.fastest},
          {"fastest_leap_m_s", ifAny(health.leaps, health.fastestLeap)},
          {"frozen", health.frozen},
          {"heading_ratio", ifAny(health.compared, health.headingRatio)},
          {"heading_unexplained", ifAny(health.compared, health.headingResidual)},
          {"direction_cosine", ifAny(health.directions, health.directionCosine)},
          {"fault", fault.empty() ? nlohmann::json(nullptr) : nlohmann::json(fault)}};
}

std::string EyeWatch::after(const std::optional<odometry::StereoHealth>& health, bool last) {
  using odometry::StereoFault;
  if (!health) return {};
  const bool found = !health->ok() && health->fault != StereoFault::kUnknown;
  const StereoFault fault = found ? health->fault : StereoFault::kNone;
  if (fault != fault_) pairs_ = health->pairs;
  fault_ = fault;
  if (!found || said_ || (!last && health->pairs - pairs_ < kCertain)) return {};
  said_ = true;
  return odometry::describe(*health);
}

}  // namespace engram::apps
