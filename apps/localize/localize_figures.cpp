// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "localize_figures.h"

#include "engram/apps/program.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace engram::apps {
namespace {

constexpr const char* kCsvHeader =
    "index,stamp,label,outcome,place,place_label,best_guess,best_guess_label,posterior,similarity,inliers,"
    "verdict,best_guess_verdict,error_places,ms,reason,x,y,heading,sigma_along,sigma_across,sigma_heading,"
    "pose_error,heading_error,accepted_by";

/// F-26: right is within this many places of the truth.
constexpr double kRightPlaces = 1.25;

const char* word(evaluation::Verdict verdict) {
  switch (verdict) {
    case evaluation::Verdict::kRight:
      return "right";
    case evaluation::Verdict::kWrong:
      return "wrong";
    case evaluation::Verdict::kUnknown:
      return "";
  }
  return "";
}

/// x, y, heading and their deviations; empty columns where there is no pose.
std::string columns(const std::optional<types::RobotPose>& pose) {
  if (!pose) return ",,,,,";
  const Eigen::Isometry3d& T = pose->T_map_robot;
  const auto sigma = [&](int i) { return std::sqrt(pose->T_place_robot.cov(i, i)); };
  std::ostringstream out;
  out << std::fixed << std::setprecision(4) << T(0, 3) << ',' << T(1, 3) << ','
      << std::atan2(T(1, 0), T(0, 0)) << ',' << sigma(0) << ',' << sigma(1) << ',' << sigma(5);
  return out.str();
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

}  // namespace

std::string LocalizeFigures::label(base::PlaceId place) const {
  return place.valid() ? map_.place(place).createdLabel : std::string();
}

void LocalizeFigures::add(const types::FrameReport& report) {
  evaluation::LocalisationResult result;
  result.accepted = report.outcome == types::Outcome::kRecognised;
  if (truth_) {
    Judgement guess;
    result.answerable = truth_->answerable(report);
    if (result.accepted) result.verdict = truth_->judge(map_, report, report.place, -1.0).verdict;
    if (report.bestGuess.valid()) {
      guess = truth_->judge(map_, report, report.bestGuess, report.bestGuessInterpolated);
    } else if (result.answerable) {
      guess.verdict = evaluation::Verdict::kWrong;  // an image without an answer is not right
    }
    result.bestGuess = guess.verdict;
    result.error = guess.error;
  }
  if (truth_) results_.push_back(result);
  const auto off = truth_ && result.answerable ? truth_->poseError(map_, report) : std::nullopt;
  if (off) poseErrors_.push_back(*off);
  milliseconds_.add(report.milliseconds);
  use_.add(report);
  accepted_ += result.accepted;
  bySequence_ += report.acceptedBy == types::AcceptedBy::kSequence;
  learnt_ += report.learnt.size();
  if (csv_.wanted()) write(report, result, off);
}

void LocalizeFigures::write(const types::FrameReport& report, const evaluation::LocalisationResult& result,
                            const std::optional<PoseError>& off) {
  if (images() == 1) csv_.add(kCsvHeader);
  const auto id = [](base::PlaceId p) { return p.valid() ? std::to_string(p.value) : std::string(); };
  const types::Hypothesis best = report.hypotheses.empty() ? types::Hypothesis{} : report.hypotheses.front();
  std::ostringstream line;
  line << std::setprecision(15) << report.index << ',' << report.stamp << ',' << quoted(report.label) << ','
       << types::toString(report.outcome) << ',' << id(report.place) << ',' << quoted(label(report.place))
       << ',' << id(report.bestGuess) << ',' << quoted(label(report.bestGuess)) << ',' << std::setprecision(4)
       << best.posterior << ',' << best.similarity << ',' << best.inliers << ',' << word(result.verdict)
       << ',' << word(result.bestGuess) << ',';
  if (result.error) line << *result.error;
  line << ',' << report.milliseconds << ',' << quoted(report.reason) << ',' << columns(report.pose) << ',';
  if (off) line << off->position << ',' << off->heading;
  if (!off) line << ',';
  line << ',';
  if (result.accepted) line << types::toString(report.acceptedBy);
  csv_.add(line.str());
}

int LocalizeFigures::withinF26() const {
  const auto within = [](const auto& r) { return r.error && *r.error <= kRightPlaces; };
  return static_cast<int>(std::count_if(results_.begin(), results_.end(), within));
}

LocalizeFigures::PoseScore LocalizeFigures::poseScore() const {
  std::vector<double> position, heading;
  double nees = 0;
  for (const PoseError& e : poseErrors_) {
    position.push_back(e.position);
    heading.push_back(e.heading);
    nees += e.nees / static_cast<double>(poseErrors_.size());
  }
  return {evaluation::percentiles(position), evaluation::percentiles(heading), nees};
}

nlohmann::json LocalizeFigures::toJson() const {
  const evaluation::LocalisationScore s = evaluation::score(results_);
  const auto spread = [](const evaluation::Percentiles& p) {
    return nlohmann::json{{"mean", p.mean}, {"median", p.median}, {"p95", p.p95}, {"max", p.max}};
  };
  nlohmann::json j = {{"images", images()},
                      {"queries", truth_ ? s.queries : images()},
                      {"accepted", truth_ ? s.accepted : accepted_},
                      {"accepted_by_sequence", bySequence_},
                      {"adapted", learnt_},
                      {"causes", use_.toJson()},
                      {"ms_per_image", spread(milliseconds_.summary())},
                      {"peak_rss_bytes", peakResidentBytes()}};
  for (const char* key : {"answerable", "right", "wrong", "best_guess_right", "within_1_25_places",
                          "error_places", "pose_error", "heading_error", "pose_nees"})
    j[key] = nullptr;
  if (!truth_) return j;
  j["answerable"] = s.answerable;
  j["right"] = s.right;
  j["wrong"] = s.wrong;
  j["best_guess_right"] = s.bestGuessRight;
  if (truth_->hasPoses()) {
    j["within_1_25_places"] = withinF26();
    j["error_places"] = spread(s.error);
    if (!poseErrors_.empty()) {
      const PoseScore pose = poseScore();
      j["pose_error"] = spread(pose.position);
      j["heading_error"] = spread(pose.heading);
      j["pose_nees"] = pose.nees;
    }
  }
  return j;
}

void LocalizeFigures::print(std::ostream& out) const {
  const evaluation::LocalisationScore s = evaluation::score(results_);
  out << images() << " images, " << accepted_ << " accepted";
  if (bySequence_ > 0) out << " (" << bySequence_ << " by the sequence)";
  if (learnt_ > 0) out << ", " << learnt_ << " learnt from";
  out << "\n";
  if (truth_) {
    out << "  of " << s.queries << " with truth: " << s.accepted << " accepted, " << s.right << " right, "
        << s.wrong << " wrong; best guess right " << s.bestGuessRight;
    if (truth_->hasPoses()) out << "; within " << kRightPlaces << " places " << withinF26();
    out << "\n";
  }
  if (!poseErrors_.empty()) {
    const PoseScore pose = poseScore();
    out << std::fixed << std::setprecision(3) << "  pose: median error " << pose.position.median
        << " m (95 %: " << pose.position.p95 << "), heading " << pose.heading.median
        << " rad (95 %: " << pose.heading.p95 << ")\n";
  }
  const evaluation::Percentiles ms = milliseconds_.summary();
  out << std::fixed << std::setprecision(1) << "  " << ms.mean << " ms per image (95 %: " << ms.p95
      << ", max: " << ms.max << ")\n"
      << use_.summary();
}

}  // namespace engram::apps
