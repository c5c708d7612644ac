// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_command.h"

#include "engram/apps/checks.h"
#include "engram/apps/program.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "words/loop_figures.h"
#include "words/words_report.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

namespace {

/// config/words_mono.ini; a test holds the two together.
pipeline::PipelineParams wordsMono() {
  pipeline::PipelineParams p;
  p.camera.image_width = 640;
  p.extractor.upright = true;
  p.verify.model = "planar_then_essential";
  p.recognise.scorer = "tfidf_incremental";
  p.recognise.verified_scores = 10;
  p.recognise.accept_inliers = 12;
  p.recognise.accept_similarity = 0.1;
  p.recognise.sure_inliers = 60;
  p.recognise.closure_similarity = 0.2;
  p.belief.peak_sigma = 1.5;
  p.belief.floor = 0.03;
  p.belief.accept_hops = 4;
  p.place.recent_hops = 10;
  p.fsh.ltm_min_features = 600;
  return p;
}

/// config/words_odometry.ini but for the camera; a test holds the two together.
pipeline::PipelineParams wordsOdometry() {
  pipeline::PipelineParams p = wordsMono();
  p.camera.image_width = 0;
  p.select.min_distance = 0.5;
  p.place.spacing = 0.5;
  p.belief.advance = "odometry";
  p.belief.view_sigma = 30 * M_PI / 180;
  return p;
}

/// Options that mean something with --images alone.
const std::vector<std::string> kImageOptions{"--truth", "--truth-margin", "--reference",
                                             "--gap",   "--stops",        "--reverse"};

}  // namespace

void WordsCommand::declare(CLI::App& command) {
  command_ = &command;
  options_.declare(command);
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

std::string WordsCommand::readConfig() {
  base::Config config;
  pipeline::PipelineParams& pipeline = onImages() ? benchmark_.pipeline : pipeline_;
  pipeline = onImages() ? wordsMono() : wordsOdometry();
  if (!onImages()) {
    world_.drive.spacing = 0.26;  // the rule of A-06 uses about every second image
    if (options_.quick) words_.attempts = 20;
    config.bind("words_world", words_);
    config.bind("change", world_.change);
    config.bind("drive", world_.drive);
    config.bind("sensor", world_.sensor);
  }
  pipeline.bind(config);
  base::IniFile ini = options_.config.empty() ? base::IniFile::parse("", "command line")
                                              : base::IniFile::load(options_.config);
  for (const auto& assignment : options_.overrides) ini.override(assignment);
  config.read(ini);
  if (onImages()) pipeline.recognise.threads = options_.threadsInUse();
  return config.dump();
}

int WordsCommand::run(std::ostream& out, std::ostream& err) {
  if (!onImages()) refuseImageOptions();
  const std::string settings = readConfig();
  if (options_.dump) {
    out << settings;
    return kOk;
  }
  return onImages() ? runImages(settings, out, err) : runWorld(settings, out, err);
}

int WordsCommand::runWorld(const std::string& settings, std::ostream& out, std::ostream& err) {
  claimFolder(
      options_,
      settings + "\n# seed = " + std::to_string(options_.seed) + (options_.quick ? ", quick\n" : "\n"),
      {"mapping.csv", "closures.csv", "localisation.csv", "attempts.csv", "index.html"});
  world_.seed = options_.seed;
  WordsWorld experiments(
      wordsPlan(options_.quick), words_, world_, pipeline_,
      {options_.folder, options_.seed, options_.threadsInUse(), options_.quiet ? nullptr : &err});
  const WordsWorldResult result = experiments.run();
  writeResults(result, settings);
  if (!options_.quiet)
    out << toText(result) << "report: " << (fs::path(options_.folder) / "index.html").string() << "\n";
  return kOk;
}

void WordsCommand::writeResults(const WordsWorldResult& result, const std::string& settings) const {
  const fs::path folder = options_.folder;
  const auto write = [&](const char* name, const std::string& text) {
    base::writeText((folder / name).string(), text, true);
  };
  write("mapping.csv", mappingCsv(result));
  write("closures.csv", closuresCsv(result));
  write("localisation.csv", localisationCsv(result));
  write("attempts.csv", attemptsCsv(result));
  write("index.html", toHtml(result, wordsPlan(options_.quick), words_, settings, options_.seed));
  nlohmann::json json = toJson(result);
  json["seed"] = options_.seed;
  writeJson(options_.json, json);
}

int WordsCommand::runImages(const std::string& settings, std::ostream& out, std::ostream& err) {
  if (truthFile_.empty()) throw UsageError("--images needs --truth: a file with the ground truth");
  const auto truth = evaluation::Truth::load(truthFile_, {margin_, 1.0, 1.0});
  claimFolder(options_,
              settings + "\n# images = " + benchmark_.images + "\n# reference = " + benchmark_.reference +
                  "\n# truth = " + truthFile_ + "\n",
              {"answers.csv", "curve.csv", "index.html"});
  benchmark_.progress = options_.quiet ? nullptr : &err;
  const auto answers = benchmark_.run(truth);
  const LoopFigures figures = figuresOf(answers);
  const fs::path folder = options_.folder;
  base::writeText((folder / "answers.csv").string(), answersCsv(answers), true);
  base::writeText((folder / "curve.csv").string(), curveCsv(figures.curve), true);
  base::writeText((folder / "index.html").string(), toHtml(figures, answers, settings), true);
  writeJson(options_.json, toJson(figures));
  if (!options_.quiet) out << toText(figures);
  return kOk;
}

}  // namespace engram::apps
