// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/images_command.h"

#include "common/methods.h"
#include "common/table.h"
#include "engram/apps/checks.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/evaluation/truth_match.h"
#include "engram/pipeline/recogniser.h"
#include "engram/sources/image_folder_source.h"

#include <filesystem>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kBlock = 10;  // images in a row that the bootstrap keeps together

evaluation::FrameRef reference(const types::Frame& frame) {
  return {frame.index, frame.label, frame.stamp, std::nullopt};
}

std::vector<LearnView> every(const std::vector<LearnView>& views, std::size_t parity) {
  std::vector<LearnView> chosen;
  for (std::size_t i = parity; i < views.size(); i += 2) chosen.push_back(views[i]);
  return chosen;
}

ResultTable tableOf(const std::vector<ImagesResult>& results) {
  using R = ImagesResult;
  Columns<R> c;
  c.add("method", &R::method).csv().json().text("method", 17);
  const auto share = [&c](const std::string& name, evaluation::Interval R::*member) {
    c.add(name, member)
        .csv(4)
        .json(name + ".share", name + ".low", name + ".high")
        .text(name, 21, percent(1));
  };
  share("single_before", &R::singleBefore);
  share("single_after", &R::singleAfter);
  share("filtered_before", &R::filteredBefore);
  share("filtered_after", &R::filteredAfter);
  c.add("accepted", [](const R& r) { return r.learning.accepted; }).csv().json();
  c.add("wrong", [](const R& r) { return r.learning.wrong; }).csv().json("accepted_wrong");
  c.add("", [](const R& r) { return line("%8d (%2d)", r.learning.accepted, r.learning.wrong); }).text("", 0);
  c.add("learnt", [](const R& r) { return r.learning.learnt; }).csv().json().text("learnt", -11);
  c.add("bytes_per_place", [](const R& r) { return r.holdings.bytesPerPlace; })
      .csv()
      .json()
      .text("kB a place", -11, kilo(1));
  return c.table(results);
}

const char* const kHead =
    "% right of the images not learnt from [95 % interval]:\n"
    "method             single before         single after          "
    "filtered before       filtered after      accepted (wrong)  learnt  kB a place";

}  // namespace

std::string ImagesCommand::description() const {
  return "The same memories on two real traversals of one way";
}

std::string ImagesCommand::examples() const {
  return "  engram-eval images --config config/fsh_mono.ini --reference day_left --query day_right "
         "--truth truth.csv --out gardens\n";
}

void ImagesCommand::declareMore(CLI::App& command) {
  command.add_option("--reference", reference_, "Folder of images of the first traversal: the map");
  command.add_option("--query", query_, "Folder of images of the second traversal");
  command.add_option("--truth", truthFile_, "Ground truth: query,first,last | image,matches | a,b links");
  command.add_option("--truth-margin", margin_, "Widens the truth by so many images")->check(wholeFrom(0));
}

void ImagesCommand::check() {
  if (reference_.empty() || query_.empty() || truthFile_.empty())
    throw UsageError("--reference, --query and --truth are all needed");
  truth_ = evaluation::Truth::load(truthFile_, {margin_, 1.0, 1.0});
}

std::string ImagesCommand::identity() const {
  return "# reference = " + reference_ + "\n# query = " + query_ + "\n";
}

std::vector<LearnView> ImagesCommand::readImages(const std::string& folder, pipeline::Perception& perception,
                                                 std::ostream* err) const {
  const auto source = sources::openImageFolder(folder);
  base::Progress progress(err, "reading " + fs::path(folder).filename().string());
  std::vector<LearnView> views;
  while (auto frame = source->next()) {
    if (base::interrupted()) throw base::Interrupted("reading " + folder);
    if (const std::string problem = perception.refusal(frame->image); !problem.empty())
      throw base::Error(folder + ": " + frame->label + ": " + problem);
    LearnView view{std::move(*frame), {}};
    view.features = perception(view.frame.image);
    view.frame.image.release();
    views.push_back(std::move(view));
    progress.update(source->progress(), views.size());
  }
  if (!source->problem().empty()) throw base::Error(source->problem());
  return views;
}

void ImagesCommand::requireTruthOf(const std::vector<LearnView>& references,
                                   const std::vector<LearnView>& query) const {
  evaluation::TruthMatch match;
  for (const auto& view : query) match.addImage(*truth_, reference(view.frame));
  for (const auto& view : references) match.addPlace(*truth_, reference(view.frame));
  if (const auto problem = match.problem(*truth_); !problem.empty()) throw base::Error(problem);
}

bool ImagesCommand::isRight(const LearnView& query, const LearnView& place) const {
  return truth_->judge(reference(query.frame), reference(place.frame)) == evaluation::Verdict::kRight;
}

evaluation::Interval ImagesCommand::locate(const Contender& contender, const Method& method,
                                           const std::vector<LearnView>& references,
                                           const std::vector<LearnView>& query, bool filtered) const {
  pipeline::Recogniser filter(method.params, pipeline::Recogniser::Mode::kLocalisation);
  filter.load(contender.map());
  std::vector<evaluation::BlockSample> samples;
  for (std::size_t i = 0; i < query.size(); ++i) {
    if (!filtered) filter.restart();
    const auto hypotheses = filter.weigh(contender.scores(query[i].features), std::nullopt);
    if (!truth_->answerable(reference(query[i].frame))) continue;
    const bool right = isRight(query[i], references[hypotheses.front().place.value]);
    samples.push_back({static_cast<int>(i / kBlock), right ? 1.0 : 0.0, 1.0});
  }
  return evaluation::blockBootstrapShare(samples);
}

ImagesResult ImagesCommand::measureOne(const Method& method, const std::vector<LearnView>& references,
                                       const std::vector<LearnView>& query) const {
  std::vector<Eigen::Isometry3d> poses;  // in a row: without odometry only the order is known
  for (std::size_t i = 0; i < references.size(); ++i)
    poses.emplace_back(Eigen::Translation3d(static_cast<double>(i), 0, 0));
  const auto contender = makeContender(method, references, poses, false);
  const auto lessons = every(query, 0), exam = every(query, 1);
  ImagesResult result;
  result.method = method.name;
  result.singleBefore = locate(*contender, method, references, exam, false);
  result.filteredBefore = locate(*contender, method, references, exam, true);
  result.learning = contender->learn(lessons, [&](std::size_t i, base::PlaceId place) {
    return isRight(lessons[i], references[place.value]);
  });
  result.singleAfter = locate(*contender, method, references, exam, false);
  result.filteredAfter = locate(*contender, method, references, exam, true);
  result.holdings = contender->holdings();
  return result;
}

Findings ImagesCommand::measure(const Workplace& place, const std::string&) {
  pipeline::Perception perception(pipeline_.camera, pipeline_.extractor);
  const auto references = readImages(reference_, perception, place.progress);
  const auto query = readImages(query_, perception, place.progress);
  requireTruthOf(references, query);

  const auto methods = comparedMethods(pipeline_, options().quick ? 200 : 1000);
  std::vector<ImagesResult> measured(methods.size());
  base::parallelFor(methods.size(), place.threads, [&](std::size_t m) {
    if (base::interrupted()) throw base::Interrupted("locating images");
    measured[m] = measureOne(methods[m], references, query);
  });
  const ResultTable table = tableOf(measured);
  return {{{"results.csv", table.toCsv()}}, {{"results", table.toJson()}}, table.toText(kHead)};
}

}  // namespace engram::apps
