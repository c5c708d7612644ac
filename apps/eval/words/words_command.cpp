// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_command.h"

#include "engram/apps/checks.h"
#include "words/loop_figures.h"
#include "words/words_report.h"

namespace engram::apps {
namespace {

/// Options that mean something with --images alone.
const std::vector<std::string> kImageOptions{"--truth", "--truth-margin", "--reference",
                                             "--gap",   "--stops",        "--reverse"};

}  // namespace

std::string WordsCommand::description() const {
  return "Maps and localisation by visual words and odometry, on the simulator; or, with --images, "
         "loop closures on images with ground truth";
}

std::string WordsCommand::examples() const {
  return "  engram-eval words --images walk --truth truth.csv --out loops --json loops.json\n"
         "  engram-eval words --out words --json words.json\n";
}

void WordsCommand::declareMore(CLI::App& command) {
  command_ = &command;
  command.add_option("--images", benchmark_.images,
                     "Folder of images, shown in the order of their names; without it the simulator");
  command.add_option("--reference", benchmark_.reference,
                     "Folder of images that make a map first; --images are then located in it");
  command.add_option("--truth", truthFile_,
                     "Ground truth: query,first,last | image,matches | a,b links | TUM");
  command.add_option("--truth-margin", margin_, "Widens the truth by so many images")->check(wholeFrom(0));
  command
      .add_option("--gap", benchmark_.gap,
                  "Without --reference: answers this near in the sequence are no loops")
      ->capture_default_str()
      ->check(wholeFrom(0));
  command
      .add_option("--stops", benchmark_.play.stops,
                  "The robot stands still at three points, so many images each")
      ->check(wholeFrom(0));
  command
      .add_option("--reverse", benchmark_.play.reverse,
                  "Half-way the robot goes back so many images, and then forward again")
      ->check(wholeFrom(0));
}

void WordsCommand::refuseImageOptions() const {
  for (const auto& name : kImageOptions)
    if (command_->count(name) > 0)
      throw UsageError(name + " belongs to --images, which is missing; without both the simulator is used");
}

void WordsCommand::configure(base::Config& config) {
  if (onImages()) {
    benchmark_.pipeline = shippedPipeline("words_mono.ini");
    benchmark_.pipeline.bind(config);
    return;
  }
  refuseImageOptions();
  pipeline_ = shippedPipeline("words_odometry.ini");
  world_.seed = options().seed;
  world_.drive.spacing = 0.26;  // the rule of A-06 uses about every second image
  if (options().quick) words_.attempts = 20;
  config.bind("words_world", words_);
  config.bind("change", world_.change);
  config.bind("drive", world_.drive);
  config.bind("sensor", world_.sensor);
  pipeline_.bind(config);
}

void WordsCommand::adjust(const base::IniFile&) {
  if (onImages()) benchmark_.pipeline.recognise.threads = options().threadsInUse();
}

void WordsCommand::check() {
  if (!onImages()) return;
  if (truthFile_.empty()) throw UsageError("--images needs --truth: a file with the ground truth");
  truth_ = evaluation::Truth::load(truthFile_, {margin_, 1.0, 1.0});
}

std::string WordsCommand::identity() const {
  if (!onImages()) return seedAndSize();
  return "# images = " + benchmark_.images + "\n# reference = " + benchmark_.reference +
         "\n# truth = " + truthFile_ + "\n";
}

std::vector<std::string> WordsCommand::results() const {
  if (onImages()) return {"answers.csv", "curve.csv", "index.html"};
  return {"mapping.csv", "closures.csv", "localisation.csv", "attempts.csv", "index.html"};
}

Findings WordsCommand::measure(const Workplace& place, const std::string& settings) {
  return onImages() ? measureImages(place, settings) : measureWorld(place, settings);
}

Findings WordsCommand::measureWorld(const Workplace& place, const std::string& settings) {
  const WordsPlan& plan = wordsPlan(options().quick);
  const WordsWorldResult result = WordsWorld(plan, words_, world_, pipeline_, place).run();
  Findings findings;
  findings.files = {{"mapping.csv", mappingTable(result).toCsv()},
                    {"closures.csv", closureTable(result).toCsv()},
                    {"localisation.csv", localisationTable(result).toCsv()},
                    {"attempts.csv", attemptTable(result).toCsv()},
                    {"index.html", toHtml(result, plan, words_, settings, place.seed)}};
  findings.figures = toJson(result);
  findings.figures["seed"] = place.seed;
  findings.summary = toText(result);
  findings.report = "index.html";
  return findings;
}

Findings WordsCommand::measureImages(const Workplace& place, const std::string& settings) {
  benchmark_.progress = place.progress;
  const auto answers = benchmark_.run(*truth_);
  const LoopFigures figures = figuresOf(answers);
  Findings findings;
  findings.files = {{"answers.csv", tableOf(answers).toCsv()},
                    {"curve.csv", tableOf(figures.curve).toCsv()},
                    {"index.html", toHtml(figures, answers, settings)}};
  findings.figures = toJson(figures);
  findings.summary = toText(figures);
  return findings;
}

}  // namespace engram::apps
