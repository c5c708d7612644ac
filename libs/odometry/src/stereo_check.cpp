// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/stereo_check.h"

#include "patch_matcher.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace engram::odometry {
namespace {

constexpr int kCorners = 250;
constexpr int kBlank = 20;           // patches from which an eye shows something; the other must show …
constexpr int kFactor = 4;           // … so many times more for this one to count as blank
constexpr float kRows = 24;          // [px] to search up and down
constexpr float kSameRow = 1.5f;     // [px]: corners are found to one pixel
constexpr float kNoise = 0.75f;      // [px] by which a disparity may be negative
constexpr int kEnough = 100;         // matches from which a verdict is possible
constexpr double kGood = 0.8;        // share in agreement that a sound camera reaches
constexpr double kClearly = 0.07;    // difference of shares that tells two readings apart
constexpr std::size_t kKept = 4096;  // row errors remembered

void count(const std::vector<Shift>& shifts, RowAgreement& to, float sign = 1) {
  to.matches += static_cast<int>(shifts.size());
  to.agree += static_cast<int>(std::count_if(shifts.begin(), shifts.end(), [sign](const Shift& s) {
    return std::abs(s.up) <= kSameRow && sign * s.left >= -kNoise;
  }));
}

}  // namespace

class StereoCheck::Impl {
 public:
  explicit Impl(int every) : every_(std::max(2, every)) {}

  void add(const types::StereoPair& pair) {
    const int phase = frame_++ % every_;
    if (phase == 0) before_ = look(pair);
    if (phase == 1 && before_) {
      const auto now = look(pair);
      if (now) compareTimes(*before_, *now);
      before_.reset();
    }
  }

  StereoHealth health() const {
    StereoHealth out = health_;
    std::vector<float> errors = rowErrors_;
    if (!errors.empty()) {
      const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
      std::nth_element(errors.begin(), middle, errors.end());
      out.rowError = *middle;
    }
    out.fault = verdict(out);
    return out;
  }

 private:
  struct Eyes {
    std::vector<Patch> left, right;
    float columns = 0;
  };

  std::optional<Eyes> look(const types::StereoPair& pair);
  void compareTimes(const Eyes& before, const Eyes& now);
  static StereoFault verdict(const StereoHealth& h);

  int every_, frame_ = 0;
  std::optional<Eyes> before_;
  StereoHealth health_;
  std::vector<float> rowErrors_;
};

/// Compares the eyes of one frame; none when one of them is blank.
std::optional<StereoCheck::Impl::Eyes> StereoCheck::Impl::look(const types::StereoPair& pair) {
  Eyes eyes{cornerPatches(pair.left, kCorners), cornerPatches(pair.right, kCorners),
            static_cast<float>(pair.left.cols) / 4};
  ++health_.pairs;
  const int left = static_cast<int>(eyes.left.size()), right = static_cast<int>(eyes.right.size());
  const bool leftBlank = left < kBlank && right >= kFactor * kBlank;
  const bool rightBlank = right < kBlank && left >= kFactor * kBlank;
  health_.leftBlank += leftBlank;
  health_.rightBlank += rightBlank;
  if (leftBlank || rightBlank) return std::nullopt;
  const auto shifts = matchPatches(eyes.left, eyes.right, eyes.columns, kRows);
  count(shifts, health_.together);
  count(shifts, health_.swapped, -1);
  for (const auto& shift : shifts) health_.negative += shift.left < -kNoise;
  for (const auto& shift : shifts)
    if (rowErrors_.size() < kKept) rowErrors_.push_back(std::abs(shift.up));
  return eyes;
}

void StereoCheck::Impl::compareTimes(const Eyes& before, const Eyes& now) {
  count(matchPatches(before.left, now.right, now.columns, kRows), health_.late);
  count(matchPatches(now.left, before.right, now.columns, kRows), health_.early);
}

StereoFault StereoCheck::Impl::verdict(const StereoHealth& h) {
  if (h.pairs >= 3 && 2 * h.leftBlank >= h.pairs) return StereoFault::kLeftBlank;
  if (h.pairs >= 3 && 2 * h.rightBlank >= h.pairs) return StereoFault::kRightBlank;
  if (h.together.matches < kEnough) return StereoFault::kUnknown;
  const double share = h.together.share();
  const auto clearly = [share](const RowAgreement& other) {
    // Both shares are of samples; four of their deviations.
    const double noise = 4 * std::sqrt(0.25 / std::max(1, other.matches));
    return other.matches >= kEnough && other.share() > share + std::max(kClearly, noise);
  };
  if (clearly(h.swapped)) return StereoFault::kSwapped;
  if (clearly(h.late) && h.late.share() > h.early.share()) return StereoFault::kRightLate;
  if (clearly(h.early)) return StereoFault::kRightEarly;
  return share >= kGood ? StereoFault::kNone : StereoFault::kRows;
}

std::string describe(const StereoHealth& h) {
  char text[320] = "";
  const auto percent = [](const RowAgreement& a) { return 100 * a.share(); };
  switch (h.fault) {
    case StereoFault::kNone:
    case StereoFault::kUnknown:
      break;
    case StereoFault::kLeftBlank:
    case StereoFault::kRightBlank: {
      const bool left = h.fault == StereoFault::kLeftBlank;
      std::snprintf(
          text, sizeof text,
          "the %s eye shows nothing in %d of %d pairs looked at, while the other one does; is it covered, "
          "or unplugged?",
          left ? "left" : "right", left ? h.leftBlank : h.rightBlank, h.pairs);
      break;
    }
    case StereoFault::kSwapped:
      std::snprintf(
          text, sizeof text,
          "left and right are swapped: %.0f %% of %d matches have a negative disparity; exchange the images "
          "or the two cameras of the calibration",
          percent(h.swapped), h.swapped.matches);
      break;
    case StereoFault::kRightLate:
    case StereoFault::kRightEarly: {
      const bool late = h.fault == StereoFault::kRightLate;
      std::snprintf(
          text, sizeof text,
          "the eyes are out of step: right images fit the left ones of the frame %s (%.0f %% of %d matches "
          "in one row) better than those of their own (%.0f %%); synchronise the cameras or shift the stamps",
          late ? "before" : "after", percent(late ? h.late : h.early),
          late ? h.late.matches : h.early.matches, percent(h.together));
      break;
    }
    case StereoFault::kRows:
      std::snprintf(
          text, sizeof text,
          "the images are not rectified by this calibration: only %.0f %% of %d matches are in one row, the "
          "median is %.1f px apart; %s",
          percent(h.together), h.together.matches, h.rowError,
          2 * h.negative > h.together.matches
              ? "most disparities are negative: are left and right swapped?"
              : "calibrate again, or give the calibration of the images as they are");
      break;
  }
  return text;
}

const char* toString(StereoFault fault) {
  switch (fault) {
    case StereoFault::kNone:
      return "none";
    case StereoFault::kUnknown:
      return "unknown";
    case StereoFault::kLeftBlank:
      return "left_blank";
    case StereoFault::kRightBlank:
      return "right_blank";
    case StereoFault::kSwapped:
      return "swapped";
    case StereoFault::kRightLate:
      return "right_late";
    case StereoFault::kRightEarly:
      return "right_early";
    case StereoFault::kRows:
      return "rows";
  }
  return "?";
}

StereoCheck::StereoCheck(int every) : impl_(std::make_unique<Impl>(every)) {}
StereoCheck::~StereoCheck() = default;
StereoCheck::StereoCheck(StereoCheck&&) noexcept = default;
StereoCheck& StereoCheck::operator=(StereoCheck&&) noexcept = default;
void StereoCheck::add(const types::StereoPair& pair) { impl_->add(pair); }
StereoHealth StereoCheck::health() const { return impl_->health(); }

}  // namespace engram::odometry
