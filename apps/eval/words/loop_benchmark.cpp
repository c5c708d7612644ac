// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/loop_benchmark.h"

#include "engram/base/error.h"
#include "engram/base/image_header.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/evaluation/truth_match.h"
#include "engram/pipeline/pipeline.h"
#include "engram/sources/image_folder_source.h"

#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <limits>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

using evaluation::FrameRef;
using evaluation::Truth;
using evaluation::Verdict;

constexpr int kReported = 100;  // hypotheses: what recall@K looks at, and those too near to count

/// The images of a folder by number, read when they are shown.
class ImageFolder {
 public:
  explicit ImageFolder(const std::string& folder) : folder_(folder), names_(sources::listImages(folder)) {}

  std::size_t size() const { return names_.size(); }

  /// @param step how many images were shown before: the time
  types::Frame frame(std::size_t i, std::size_t step) const {
    types::Frame frame;
    frame.index = i;
    frame.stamp = static_cast<double>(step);
    frame.label = names_[i];
    const std::string path = (fs::path(folder_) / names_[i]).string();
    frame.image = cv::imdecode(base::readImageBytes(path), cv::IMREAD_COLOR);
    if (frame.image.empty()) throw base::Error(path + " cannot be read as an image; repair or remove it");
    return frame;
  }

 private:
  std::string folder_;
  std::vector<std::string> names_;
};

/// For the truth an image has the time at which it was taken, whenever it is shown: one second apart.
FrameRef refOf(std::uint64_t index, const std::string& label, const Truth& truth) {
  const auto stamp = static_cast<double>(index);
  return {index, label, stamp, truth.position(stamp)};
}

FrameRef refOf(const map::Place& place, const Truth& truth) {
  return refOf(place.createdIndex, place.createdLabel, truth);
}

/// Tells which answers count, and what they are worth.
class Judge {
 public:
  /// @param gap none: the places come from another drive, and all count
  Judge(const Truth& truth, std::optional<int> gap) : truth_(truth), gap_(gap) {}

  LoopAnswer answer(const types::Frame& frame, const types::FrameReport& report,
                    const map::TopologicalMap& map) {
    LoopAnswer a;
    a.query = refOf(frame.index, frame.label, truth_);
    a.positive = positive(a.query);
    a.outcome = report.outcome;
    shown_.push_back(a.query);
    int rank = 0;
    const types::Hypothesis* chosen = nullptr;
    for (const auto& hypothesis : report.hypotheses) {
      const FrameRef place = refOf(map.place(hypothesis.place), truth_);
      if (!counts(a.query, place)) continue;
      const Verdict verdict = truth_.judge(a.query, place);
      if (rank == 0) a.bestGuess = verdict;
      if (verdict == Verdict::kRight && a.rank < 0) a.rank = rank;
      const bool isAccepted =
          report.outcome == types::Outcome::kRecognised && hypothesis.place == report.place;
      if (rank == 0 || isAccepted) chosen = &hypothesis;
      a.accepted = a.accepted || isAccepted;
      ++rank;
    }
    if (!chosen) return a;
    a.place = refOf(map.place(chosen->place), truth_);
    a.verdict = truth_.judge(a.query, *a.place);
    a.score = std::max(0, chosen->inliers) + chosen->posterior;
    return a;
  }

 private:
  bool counts(const FrameRef& query, const FrameRef& place) const {
    const auto apart = static_cast<std::int64_t>(query.index) - static_cast<std::int64_t>(place.index);
    return !gap_ || std::abs(apart) > *gap_;
  }

  bool positive(const FrameRef& query) const {
    if (!gap_) return truth_.answerable(query);
    return std::any_of(shown_.begin(), shown_.end(), [&](const FrameRef& earlier) {
      return counts(query, earlier) && truth_.judge(query, earlier) == Verdict::kRight;
    });
  }

  const Truth& truth_;
  std::optional<int> gap_;
  std::vector<FrameRef> shown_;
};

using Process = std::function<types::FrameReport(const types::Frame&)>;
using Record = std::function<void(const types::Frame&, const types::FrameReport&, double milliseconds)>;

void show(const std::string& folder, const PlayOptions& options, std::ostream* err, const Process& process,
          const Record& record) {
  const ImageFolder images(folder);
  const auto order = playingOrder(images.size(), options);
  base::Progress progress(err, fs::path(folder).filename().string());
  for (std::size_t step = 0; step < order.size(); ++step) {
    if (base::interrupted()) throw base::Interrupted("showing " + folder);
    const types::Frame frame = images.frame(order[step], step);
    const auto start = std::chrono::steady_clock::now();
    const types::FrameReport report = process(frame);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    record(frame, report, took.count());
    progress.update(static_cast<double>(step + 1) / static_cast<double>(order.size()), step + 1);
  }
}

/// Throws base::Error when the truth cannot be that of these images.
void requireTruthOf(const Truth& truth, const std::string& images, const std::string& reference) {
  evaluation::TruthMatch match;
  const auto names = sources::listImages(images);
  for (std::size_t i = 0; i < names.size(); ++i) match.addImage(truth, refOf(i, names[i], truth));
  const auto places = reference.empty() ? std::vector<std::string>{} : sources::listImages(reference);
  for (std::size_t i = 0; i < places.size(); ++i) match.addPlace(truth, refOf(i, places[i], truth));
  if (const auto problem = match.problem(truth); !problem.empty()) throw base::Error(problem);
}

}  // namespace

std::vector<std::size_t> playingOrder(std::size_t images, const PlayOptions& options) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < images; ++i) {
    order.push_back(i);
    for (std::size_t quarter = 1; quarter <= 3; ++quarter)
      if (i == images * quarter / 4) order.insert(order.end(), static_cast<std::size_t>(options.stops), i);
    if (i != images / 2) continue;
    const std::size_t back = std::min(static_cast<std::size_t>(options.reverse), i);
    for (std::size_t k = 1; k <= back; ++k) order.push_back(i - k);
    for (std::size_t k = back; k-- > 0;) order.push_back(i - k);
  }
  return order;
}

std::vector<LoopAnswer> LoopBenchmark::run(const Truth& truth) const {
  requireTruthOf(truth, images, reference);
  pipeline::PipelineParams params = pipeline;
  params.recognise.reported = std::max(params.recognise.reported, kReported);
  pipeline::Pipeline mapper(params);
  std::vector<LoopAnswer> answers;
  const auto answerer = [&](Judge& judge, const map::TopologicalMap& map) -> Record {
    return [&](const types::Frame& frame, const types::FrameReport& report, double milliseconds) {
      answers.push_back(judge.answer(frame, report, map));
      answers.back().milliseconds = milliseconds;
    };
  };
  const Process map = [&](const types::Frame& frame) { return mapper.process(frame); };
  if (reference.empty()) {
    Judge judge(truth, gap);
    show(images, play, progress, map, answerer(judge, mapper.map()));
    return answers;
  }
  show(reference, {}, progress, map, [](const auto&, const auto&, double) {});
  mapper.finish();
  pipeline::Pipeline localizer(params, std::move(mapper).release(), pipeline::Use::kFrozen);
  Judge judge(truth, std::nullopt);
  show(
      images, play, progress, [&](const types::Frame& f) { return localizer.process(f); },
      answerer(judge, localizer.map()));
  return answers;
}

}  // namespace engram::apps
