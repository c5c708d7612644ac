// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "panel.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdio>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace engram::viewer {
namespace {

using types::Outcome;

const cv::Scalar kBackground(28, 28, 28), kText(230, 230, 230), kFaint(150, 150, 150);
const cv::Scalar kLongTerm(80, 220, 80), kShortTerm(40, 160, 255), kUnknown(150, 150, 150);
const cv::Scalar kNewPlace(255, 170, 60);

cv::Scalar colourOf(RobotState state) {
  switch (state) {
    case RobotState::kTracking:
      return {70, 170, 70};
    case RobotState::kNewPlace:
      return {190, 120, 30};
    case RobotState::kLost:
      return {50, 50, 200};
    case RobotState::kBlind:
      break;
  }
  return {90, 90, 90};
}

cv::Scalar colourOf(Mark::Kind kind) {
  return kind == Mark::Kind::kLongTerm ? kLongTerm : kind == Mark::Kind::kShortTerm ? kShortTerm : kUnknown;
}

void write(cv::Mat& panel, const std::string& text, cv::Point at, const cv::Scalar& colour,
           double scale = 0.5) {
  cv::putText(panel, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

cv::Mat colour(const cv::Mat& image) {
  if (image.channels() == 3) return image;
  cv::Mat bgr;
  cv::cvtColor(image, bgr, cv::COLOR_GRAY2BGR);
  return bgr;
}

/// Draws the image as large as it fits; returns its scale and corner.
std::pair<double, cv::Point> fit(cv::Mat& panel, const cv::Mat& image, const cv::Rect& box) {
  const double scale = std::min(1.0 * box.width / image.cols, 1.0 * box.height / image.rows);
  cv::Mat scaled;
  cv::resize(colour(image), scaled, {}, scale, scale, scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  const cv::Point corner(box.x + (box.width - scaled.cols) / 2, box.y + (box.height - scaled.rows) / 2);
  const cv::Rect target = cv::Rect(corner, scaled.size()) & cv::Rect({0, 0}, panel.size());
  scaled({0, 0, target.width, target.height}).copyTo(panel(target));
  return {scale, corner};
}

void drawImage(cv::Mat& panel, const PanelContent& content, const cv::Rect& box) {
  if (content.image.empty()) return;
  const auto [scale, corner] = fit(panel, content.image, box);
  // Long-term features last: they lie on top.
  for (const auto kind : {Mark::Kind::kUnknown, Mark::Kind::kShortTerm, Mark::Kind::kLongTerm})
    for (const Mark& mark : content.marks) {
      if (mark.kind != kind) continue;
      const cv::Point at(cvRound(corner.x + scale * mark.at.x), cvRound(corner.y + scale * mark.at.y));
      const int radius = std::clamp(cvRound(0.3 * scale * mark.size), 2, 6);
      cv::circle(panel, at, radius, colourOf(kind), 1, cv::LINE_AA);
    }
}

int bestInliers(const types::FrameReport& report) {
  int inliers = -1;
  for (const auto& h : report.hypotheses) inliers = std::max(inliers, h.inliers);
  return inliers;
}

void drawState(cv::Mat& panel, const PanelContent& content, const cv::Rect& box) {
  cv::rectangle(panel, box, colourOf(content.state), cv::FILLED);
  const auto& report = content.report;
  std::string text = toString(content.state);
  if (report.place.valid()) text += ": place " + std::to_string(report.place.value);
  write(panel, text, {box.x + 10, box.y + 26}, {255, 255, 255}, 0.75);
  char right[96];
  std::snprintf(right, sizeof right, "image %llu   %zu places", static_cast<unsigned long long>(report.index),
                content.places);
  const int width = cv::getTextSize(right, cv::FONT_HERSHEY_SIMPLEX, 0.5, 1, nullptr).width;
  write(panel, right, {box.x + box.width - width - 10, box.y + 25}, {255, 255, 255});
}

/// Words side by side, each in its colour.
void writeRow(cv::Mat& panel, const std::vector<std::pair<std::string, cv::Scalar>>& words, cv::Point at) {
  for (const auto& [word, wordColour] : words) {
    write(panel, word, at, wordColour, 0.42);
    at.x += cv::getTextSize(word, cv::FONT_HERSHEY_SIMPLEX, 0.42, 1, nullptr).width + 12;
  }
}

/// Words in lines that are no wider than the box; what needs more than two is cut.
void writeWrapped(cv::Mat& panel, const std::string& text, cv::Point at, int width) {
  std::istringstream words(text);
  std::string line, word;
  int lines = 1;
  const auto fits = [width](const std::string& t) {
    return cv::getTextSize(t, cv::FONT_HERSHEY_SIMPLEX, 0.42, 1, nullptr).width <= width;
  };
  while (words >> word) {
    const std::string longer = line.empty() ? word : line + " " + word;
    if (fits(longer)) {
      line = longer;
      continue;
    }
    if (lines++ == 2) break;
    write(panel, line, at, kFaint, 0.42);
    at.y += 18;
    line = word;
  }
  while (!line.empty() && !fits(line)) line.pop_back();
  write(panel, line, at, kFaint, 0.42);
}

/// The place that is shown, and what speaks for it.
std::string evidence(const PanelContent& content) {
  const auto& report = content.report;
  if (report.outcome == Outcome::kNewPlace)
    return "place " + std::to_string(report.place.value) + " begins with these features";
  if (report.place.valid()) {
    const auto matched = std::count_if(content.marks.begin(), content.marks.end(),
                                       [](const Mark& m) { return m.kind != Mark::Kind::kUnknown; });
    return "place " + std::to_string(report.place.value) + ": " + std::to_string(matched) + " of " +
           std::to_string(content.marks.size()) + " features match";
  }
  if (!report.bestGuess.valid()) return "no place was tried";
  const int inliers = bestInliers(report);
  return "best guess: place " + std::to_string(report.bestGuess.value) +
         (inliers >= 0 ? ", inliers: " + std::to_string(inliers) : ", not tried");
}

void drawMatched(cv::Mat& panel, const PanelContent& content, const cv::Rect& box) {
  int line = box.y + 20;
  if (!content.matched.empty()) {
    const cv::Rect picture(box.x + 8, box.y + 8, box.width - 16, box.height * 9 / 16);
    fit(panel, content.matched, picture);
    line = picture.y + picture.height + 22;
  }
  write(panel, evidence(content), {box.x + 10, line}, kText);
  const auto count = [&](Mark::Kind kind) {
    return std::to_string(std::count_if(content.marks.begin(), content.marks.end(),
                                        [kind](const Mark& m) { return m.kind == kind; }));
  };
  writeRow(panel,
           {{"long-term " + count(Mark::Kind::kLongTerm), kLongTerm},
            {"short-term " + count(Mark::Kind::kShortTerm), kShortTerm},
            {"other " + count(Mark::Kind::kUnknown), kUnknown}},
           {box.x + 10, line + 21});
  writeWrapped(panel, content.report.reason, {box.x + 10, line + 42}, box.width - 18);
}

std::string likeliest(const types::FrameReport& report) {
  const auto best = std::max_element(report.hypotheses.begin(), report.hypotheses.end(),
                                     [](const auto& a, const auto& b) { return a.posterior < b.posterior; });
  const bool known = best != report.hypotheses.end() && best->posterior > report.newPlaceProbability;
  const double probability = known ? best->posterior : report.newPlaceProbability;
  if (probability <= 0.0) return "none yet";
  char text[64];
  std::snprintf(text, sizeof text, ", %.0f %%", 100.0 * probability);
  return (known ? "place " + std::to_string(best->place.value) : "new ground") + text;
}

/// Bars over the places in the order of their numbers; the new place at the right end.
void drawBelief(cv::Mat& panel, const PanelContent& content, const cv::Rect& box) {
  const cv::Rect chart(box.x + 8, box.y + 24, box.width - 16, box.height - 48);
  write(panel, "belief: " + likeliest(content.report), {chart.x, box.y + 16}, kText);
  cv::rectangle(panel, chart, kFaint, 1);
  const double slots = static_cast<double>(std::max<std::size_t>(content.places, 1)) + 1.0;
  const int width = std::clamp(cvRound(chart.width / slots * 0.8), 4, 40);
  std::vector<cv::Range> labelled;
  const auto bar = [&](double slot, double probability, const cv::Scalar& barColour,
                       const std::string& label) {
    const int x = chart.x + cvRound(chart.width * (slot + 0.5) / slots) - width / 2;
    const int height = cvRound(std::clamp(probability, 0.0, 1.0) * (chart.height - 2));
    const cv::Rect body = cv::Rect(x, chart.y + chart.height - height, width, height) & chart;
    cv::rectangle(panel, body, barColour, cv::FILLED);
    const int textWidth = cv::getTextSize(label, cv::FONT_HERSHEY_SIMPLEX, 0.4, 1, nullptr).width;
    const int left = std::clamp(x + width / 2 - textWidth / 2, chart.x, chart.x + chart.width - textWidth);
    const cv::Range span(left - 3, left + textWidth + 3);
    const bool hides = std::any_of(labelled.begin(), labelled.end(),
                                   [&](const cv::Range& other) { return !(span & other).empty(); });
    if (probability < 0.05 || hides) return;
    labelled.push_back(span);
    write(panel, label, {left, chart.y + chart.height + 14}, kText, 0.4);
  };
  auto hypotheses = content.report.hypotheses;  // the likeliest first: its number must be seen
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const auto& a, const auto& b) { return a.posterior > b.posterior; });
  for (const auto& h : hypotheses)
    bar(h.place.value, h.posterior, h.place == content.report.place ? kLongTerm : kText,
        std::to_string(h.place.value));
  bar(slots - 1.0, content.report.newPlaceProbability, kNewPlace, "new");
}

}  // namespace

RobotState stateAfter(const types::FrameReport& report, RobotState before) {
  switch (report.outcome) {
    case Outcome::kSkipped:
      return before;
    case Outcome::kUnusable:
      return RobotState::kBlind;
    case Outcome::kNewPlace:
      return RobotState::kNewPlace;
    case Outcome::kRecognised:
      return RobotState::kTracking;
    case Outcome::kRefused:
      break;
  }
  return RobotState::kLost;
}

const char* toString(RobotState state) {
  switch (state) {
    case RobotState::kTracking:
      return "tracking";
    case RobotState::kNewPlace:
      return "new place";
    case RobotState::kLost:
      return "lost";
    case RobotState::kBlind:
      break;
  }
  return "blind";
}

cv::Mat drawPanel(const PanelContent& content, cv::Size size) {
  cv::Mat panel(size, CV_8UC3, kBackground);
  constexpr int kBar = 38;
  const int upper = (size.height - kBar) * 2 / 3;
  const int lower = size.height - kBar - upper;
  drawState(panel, content, {0, 0, size.width, kBar});
  drawImage(panel, content, {0, kBar, size.width, upper});
  drawMatched(panel, content, {0, kBar + upper, size.width / 2, lower});
  drawBelief(panel, content, {size.width / 2, kBar + upper, size.width - size.width / 2, lower});
  return panel;
}

}  // namespace engram::viewer
