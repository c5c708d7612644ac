// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/odometry/stereo_check.h"

#include "patch_matcher.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace engram::odometry {
namespace {

constexpr int kCorners = 250;
constexpr int kBlank = 20;         // patches from which an eye shows something; the other must show …
constexpr int kFactor = 4;         // … so many times more for this one to count as blank
constexpr float kRows = 24;        // [px] to search up and down
constexpr float kSameRow = 1.5f;   // [px]: corners are found to one pixel
constexpr float kNoise = 0.75f;    // [px] by which a disparity may be negative
constexpr int kEnough = 100;       // matches from which a verdict is possible
constexpr double kGood = 0.8;      // share in agreement that a sound camera reaches
constexpr double kMost = 0.5;      // share in agreement without which a reading explains nothing
constexpr double kClearly = 0.07;  // difference of shares that tells two readings apart
constexpr double kLevel = 1.25;    // [px] by which all rows may be off: odometry still finds its points

/// The row differences of matches, by quarters of a pixel: how many lie together, wherever that is. Eyes that
/// are level to each other have them at 0; a constant offset must not be taken for images of another time.
class Rows {
 public:
  void add(const std::vector<Shift>& shifts) {
    for (const auto& s : shifts) {
      const auto bin =
          static_cast<std::size_t>(std::lround((std::clamp(s.up, -kRows, kRows) + kRows) * kSteps));
      ++all_[bin];
      if (s.left >= -kNoise) ++right_[bin];
      if (s.left <= kNoise) ++swapped_[bin];
      ++matches_;
    }
  }
  int matches() const { return matches_; }
  /// Median of the differences [px]; 0 without matches.
  double offset() const {
    if (matches_ == 0) return 0;
    int below = 0;
    std::size_t bin = 0;
    while (2 * (below += all_[bin]) < matches_) ++bin;
    return static_cast<double>(bin) / kSteps - kRows;
  }
  /// Median of their sizes [px]; 0 without matches.
  double error() const {
    if (matches_ == 0) return 0;
    int within = all_[kZero];
    std::size_t away = 0;
    while (2 * within < matches_) {
      ++away;
      within += all_[kZero - away] + all_[kZero + away];
    }
    return static_cast<double>(away) / kSteps;
  }
  /// Matches in one row but for an offset [px], at a disparity that is possible.
  RowAgreement about(double offset) const { return {matches_, near(right_, offset)}; }
  /// The same, with left and right exchanged.
  RowAgreement swappedAbout(double offset) const { return {matches_, near(swapped_, offset)}; }

 private:
  static constexpr int kSteps = 4;  // in a pixel
  static constexpr std::size_t kZero = static_cast<std::size_t>(kRows) * kSteps;
  using Bins = std::array<int, 2 * kZero + 1>;

  static int near(const Bins& bins, double offset) {
    const auto centre = static_cast<std::ptrdiff_t>(kZero) + std::lround(offset * kSteps);
    const auto reach = static_cast<std::ptrdiff_t>(kSameRow * kSteps);
    int sum = 0;
    for (auto bin = std::max<std::ptrdiff_t>(0, centre - reach);
         bin <= std::min(centre + reach, std::ssize(bins) - 1); ++bin)
      sum += bins[static_cast<std::size_t>(bin)];
    return sum;
  }

  Bins all_{}, right_{}, swapped_{};
  int matches_ = 0;
};

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
    out.rowError = together_.error();
    out.rowOffset = together_.offset();
    out.level = together_.about(0);
    out.together = together_.about(out.rowOffset);
    out.swapped = together_.swappedAbout(out.rowOffset);
    out.late = late_.about(late_.offset());
    out.early = early_.about(early_.offset());
    out.fault = verdict(out);
    if (out.fault == StereoFault::kRightLate) out.rowOffset = late_.offset();
    if (out.fault == StereoFault::kRightEarly) out.rowOffset = early_.offset();
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
  Rows together_, late_, early_;
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
  together_.add(shifts);
  for (const auto& shift : shifts) health_.negative += shift.left < -kNoise;
  return eyes;
}

void StereoCheck::Impl::compareTimes(const Eyes& before, const Eyes& now) {
  late_.add(matchPatches(before.left, now.right, now.columns, kRows));
  early_.add(matchPatches(now.left, before.right, now.columns, kRows));
}

StereoFault StereoCheck::Impl::verdict(const StereoHealth& h) {
  if (h.pairs >= 3 && 2 * h.leftBlank >= h.pairs) return StereoFault::kLeftBlank;
  if (h.pairs >= 3 && 2 * h.rightBlank >= h.pairs) return StereoFault::kRightBlank;
  if (h.together.matches < kEnough) return StereoFault::kUnknown;
  const double share = h.together.share();
  const auto clearly = [share](const RowAgreement& other) {
    // Both shares are of samples; four of their deviations.
    const double noise = 4 * std::sqrt(0.25 / std::max(1, other.matches));
    return other.matches >= kEnough && other.share() >= kMost &&
           other.share() > share + std::max(kClearly, noise);
  };
  if (clearly(h.swapped)) return StereoFault::kSwapped;
  if (clearly(h.late) && h.late.share() > h.early.share()) return StereoFault::kRightLate;
  if (clearly(h.early)) return StereoFault::kRightEarly;
  const bool good = h.level.share() >= kGood && std::abs(h.rowOffset) <= kLevel;
  return good ? StereoFault::kNone : StereoFault::kRows;
}

namespace {

template <class... Values>
std::string printed(const char* format, Values... values) {
  char text[400];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

double percent(const RowAgreement& a) { return 100 * a.share(); }

/// "3.0 px higher"; empty where the rows are level.
std::string offsetText(double offset) {
  if (std::abs(offset) <= kLevel) return {};
  return printed("%.1f px %s", std::abs(offset), offset > 0 ? "higher" : "lower");
}

std::string blankText(const StereoHealth& h) {
  const bool left = h.fault == StereoFault::kLeftBlank;
  return printed(
      "the %s eye shows nothing in %d of %d pairs looked at, while the other one does; is it covered, or "
      "unplugged?",
      left ? "left" : "right", left ? h.leftBlank : h.rightBlank, h.pairs);
}

std::string swappedText(const StereoHealth& h) {
  return printed(
      "left and right are swapped: %.0f %% of %d matches have a negative disparity; exchange the images or "
      "the two cameras of the calibration",
      percent(h.swapped), h.swapped.matches);
}

std::string stepText(const StereoHealth& h) {
  const bool late = h.fault == StereoFault::kRightLate;
  const RowAgreement& fits = late ? h.late : h.early;
  const std::string offset = offsetText(h.rowOffset);
  return printed(
             "the eyes are out of step: right images fit the left ones of the frame %s (%.0f %% of %d "
             "matches "
             "in one row) better than those of their own (%.0f %%); synchronise the cameras or shift the "
             "stamps",
             late ? "before" : "after", percent(fits), fits.matches, percent(h.together)) +
         (offset.empty() ? "" : ". Besides, all of the right image lies " + offset + ": calibrate again");
}

std::string rowsText(const StereoHealth& h) {
  const std::string fault = "the images are not rectified by this calibration: ";
  const std::string offset = offsetText(h.rowOffset);
  if (!offset.empty() && h.together.share() >= kGood)
    return fault + printed(
                       "all of the right image lies %s than the left one (%.0f %% of %d matches agree); "
                       "calibrate again",
                       offset.c_str(), percent(h.together), h.together.matches);
  return fault +
         printed("only %.0f %% of %d matches are in one row, the median is %.1f px apart; ", percent(h.level),
                 h.level.matches, h.rowError) +
         (2 * h.negative > h.together.matches
              ? "most disparities are negative: are left and right swapped?"
              : "calibrate again, or give the calibration of the images as they are");
}

}  // namespace

std::string describe(const StereoHealth& health) {
  switch (health.fault) {
    case StereoFault::kNone:
    case StereoFault::kUnknown:
      return {};
    case StereoFault::kLeftBlank:
    case StereoFault::kRightBlank:
      return blankText(health);
    case StereoFault::kSwapped:
      return swappedText(health);
    case StereoFault::kRightLate:
    case StereoFault::kRightEarly:
      return stepText(health);
    case StereoFault::kRows:
      return rowsText(health);
  }
  return {};
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
