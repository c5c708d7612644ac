// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/images_command.h"

#include "common/methods.h"
#include "engram/apps/checks.h"
#include "engram/apps/program.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/evaluation/truth_match.h"
#include "engram/pipeline/recogniser.h"
#include "engram/sources/image_folder_source.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <ostream>

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

std::string toCsv(const std::vector<ImagesResult>& results) {
  std::string csv =
      "method,single_before,single_after,filtered_before,filtered_after,accepted,wrong,learnt,bytes_per_"
      "place\n";
  char line[256];
  for (const auto& r : results) {
    std::snprintf(line, sizeof line, "%s,%.4f,%.4f,%.4f,%.4f,%d,%d,%d,%.0f\n", r.method.c_str(),
                  r.singleBefore.value, r.singleAfter.value, r.filteredBefore.value, r.filteredAfter.value,
                  r.learning.accepted, r.learning.wrong, r.learning.learnt, r.holdings.bytesPerPlace);
    csv += line;
  }
  return csv;
}

nlohmann::json toJson(const std::vector<ImagesResult>& results) {
  nlohmann::json list = nlohmann::json::array();
  const auto share = [](const evaluation::Interval& i) {
    return nlohmann::json{{"share", i.value}, {"low", i.low}, {"high", i.high}};
  };
  for (const auto& r : results)
    list.push_back({{"method", r.method},
                    {"single_before", share(r.singleBefore)},
                    {"single_after", share(r.singleAfter)},
                    {"filtered_before", share(r.filteredBefore)},
                    {"filtered_after", share(r.filteredAfter)},
                    {"accepted", r.learning.accepted},
                    {"accepted_wrong", r.learning.wrong},
                    {"learnt", r.learning.learnt},
                    {"bytes_per_place", r.holdings.bytesPerPlace}});
  return list;
}

void print(const std::vector<ImagesResult>& results, std::ostream& out) {
  out << "% right of the images not learnt from [95 % interval]:\n"
         "method             single before         single after          filtered before       filtered "
         "after  "
         "    accepted (wrong)  learnt  kB a place\n";
  char line[256];
  const auto cell = [](const evaluation::Interval& i) {
    char text[64];
    std::snprintf(text, sizeof text, "%5.1f [%5.1f, %5.1f]", 100 * i.value, 100 * i.low, 100 * i.high);
    return std::string(text);
  };
  for (const auto& r : results) {
    std::snprintf(line, sizeof line, "%-17s %s  %s  %s  %s  %8d (%2d)  %10d  %10.1f\n", r.method.c_str(),
                  cell(r.singleBefore).c_str(), cell(r.singleAfter).c_str(), cell(r.filteredBefore).c_str(),
                  cell(r.filteredAfter).c_str(), r.learning.accepted, r.learning.wrong, r.learning.learnt,
                  r.holdings.bytesPerPlace / 1000);
    out << line;
  }
}

}  // namespace

void ImagesCommand::declare(CLI::App& command) {
  options_.declare(command);
  command.add_option("--reference", reference_, "Folder of images of the first traversal: the map");
  command.add_option("--query", query_, "Folder of images of the second traversal");
  command.add_option("--truth", truthFile_, "Ground truth: query,first,last | image,matches | a,b links");
  command.add_option("--truth-margin", margin_, "Widens the truth by so many images")->check(wholeFrom(0));
}

std::string ImagesCommand::readConfig() {
  base::Config config;
  pipeline_.bind(config);
  base::IniFile ini = options_.config.empty() ? base::IniFile::parse("", "command line")
                                              : base::IniFile::load(options_.config);
  for (const auto& assignment : options_.overrides) ini.override(assignment);
  config.read(ini);
  return config.dump();
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

ImagesResult ImagesCommand::measure(const Method& method, const std::vector<LearnView>& references,
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

int ImagesCommand::run(std::ostream& out, std::ostream& err) {
  const std::string settings = readConfig();
  if (options_.dump) {
    out << settings;
    return kOk;
  }
  if (reference_.empty() || query_.empty() || truthFile_.empty())
    throw UsageError("--reference, --query and --truth are all needed");
  truth_ = evaluation::Truth::load(truthFile_, {margin_, 1.0, 1.0});
  claimFolder(options_, settings + "\n# reference = " + reference_ + "\n# query = " + query_ + "\n",
              {"results.csv"});
  pipeline::Perception perception(pipeline_.camera, pipeline_.extractor);
  std::ostream* progress = options_.quiet ? nullptr : &err;
  const auto references = readImages(reference_, perception, progress);
  const auto query = readImages(query_, perception, progress);
  requireTruthOf(references, query);

  const auto methods = comparedMethods(pipeline_, options_.quick ? 200 : 1000);
  std::vector<ImagesResult> results(methods.size());
  base::parallelFor(methods.size(), options_.threadsInUse(), [&](std::size_t m) {
    if (base::interrupted()) throw base::Interrupted("locating images");
    results[m] = measure(methods[m], references, query);
  });
  base::writeText((fs::path(options_.folder) / "results.csv").string(), toCsv(results), true);
  writeJson(options_.json, {{"results", toJson(results)}});
  if (!options_.quiet) print(results, out);
  return kOk;
}

}  // namespace engram::apps
