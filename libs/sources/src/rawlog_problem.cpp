// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rawlog_problem.h"

#include "engram/base/text.h"

#include <cmath>
#include <cstdio>
#include <vector>

namespace engram::sources {
namespace {

std::string named(const std::string& label) { return label.empty() ? "''" : base::printable(label); }

/// "225 observations (CObservation2DRangeScan 225) and 224 actions (CActionRobotMovement2D 224)"
std::string describeContent(const RawlogStats& stats) {
  std::size_t observations = 0, actions = 0;
  std::string observed, acted;
  for (const auto& [name, labels] : stats.objects) {
    if (name == "CSensoryFrame" || name == "CActionCollection") continue;
    std::size_t n = 0;
    for (const auto& [label, times] : labels) n += times;
    const bool isAction = name.rfind("CAction", 0) == 0;
    (isAction ? actions : observations) += n;
    auto& list = isAction ? acted : observed;
    list += (list.empty() ? "" : ", ") + name + " " + std::to_string(n);
  }
  std::string text = base::counted(observations, "observation");
  if (observations > 0) text += " (" + observed + ")";
  if (actions > 0) text += " and " + base::counted(actions, "action") + " (" + acted + ")";
  return text;
}

std::string listCameras(const RawlogStats& stats) {
  std::string list;
  for (const auto& [label, images] : stats.cameras)
    list += (list.empty() ? "" : ", ") + named(label) + " (" + base::counted(images, "image") + ")";
  return list;
}

/// "3 images left out: no image of RIGHT within 1 ms; the first lacks 33.4 ms"
std::string describeUnpaired(const RawlogStats& stats, const RawlogParams& params) {
  const auto milliseconds = [](double seconds) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g ms", 1000 * seconds);
    return std::string(text);
  };
  std::string text = base::counted(stats.imagesUnpaired, "image") + " left out: no image of " +
                     named(params.right_label) + " within " + milliseconds(params.pair_tolerance);
  if (!stats.cameras.contains(params.right_label))
    return text + ": no camera has this label; set right_label to one of: " + listCameras(stats);
  return text +
         (std::isfinite(stats.nearestRight)
              ? "; for the first of them the nearest was " + milliseconds(stats.nearestRight) + " away"
              : "; before the first of them there was none") +
         " (pair_tolerance)";
}

std::string describeChoice(const RawlogStats& stats, const RawlogParams& params,
                           const std::string& usedLabel) {
  if (!params.sensor_label.empty() && !stats.cameras.empty() && !stats.cameras.contains(params.sensor_label))
    return "no camera has the label '" + params.sensor_label +
           "'; set sensor_label to one of: " + listCameras(stats);
  const std::size_t known = params.right_label.empty() ? 1 : 2;
  if (params.sensor_label.empty() && stats.cameras.size() > known)
    return "it holds several cameras, of which " + named(usedLabel) +
           " was used; set sensor_label to choose among (and right_label, if two are a stereo pair): " +
           listCameras(stats);
  return {};
}

}  // namespace

std::string describeProblem(const std::string& path, const std::string& damage, const RawlogStats& stats,
                            const RawlogParams& params, const std::string& usedLabel) {
  std::vector<std::string> parts;
  const auto say = [&](std::size_t n, const std::string& what, const std::string& fate) {
    if (n > 0) parts.push_back(base::counted(n, what) + " " + fate);
  };
  if (!damage.empty()) parts.push_back(damage + "; " + base::counted(stats.images, "image") + " read");
  if (stats.cameras.empty()) parts.push_back("it holds " + describeContent(stats) + " but no images");
  if (const auto choice = describeChoice(stats, params, usedLabel); !choice.empty()) parts.push_back(choice);
  say(stats.imagesDamaged, "image", "left out: damaged (" + stats.firstFailure + ")");
  say(stats.imagesMissing, "image", "left out: file not found (" + stats.firstFailure + "); see images_dir");
  say(stats.imagesBadStamp - stats.imagesLeap, "image", "left out: the stamp repeats or goes back");
  say(stats.imagesLeap, "image",
      "left out: the stamp leaps ahead by more than a year, and the next ones do not");
  if (stats.imagesUnpaired > 0) parts.push_back(describeUnpaired(stats, params));
  say(stats.imagesNoStamp, "image", "without a stamp: numbered one second apart");
  say(stats.imagesNoOdometry, "image", "without odometry near in time");
  say(stats.odometryBad, "odometry reading", "left out: not a number");
  say(stats.odometryBadStamp, "odometry reading",
      "left out: the stamp repeats, goes back, or leaps ahead by more than a year");
  say(stats.odometryWild, "odometry reading",
      "left out: no robot is more than 20000 km away, or moves 10 km between two actions");
  say(stats.clockRestarts, "time", "the clock was set back: time starts anew there");
  say(stats.clockLeaps, "time", "the clock leapt ahead by more than a year: time starts anew there");
  std::string text;
  for (const auto& part : parts) text += (text.empty() ? "" : "; ") + part;
  if (text.empty() || text.rfind(path, 0) == 0) return text;
  return path + ": " + text;
}

}  // namespace engram::sources
