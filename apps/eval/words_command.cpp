// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words_command.h"

#include "engram/apps/program.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "loop_figures.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

/// config/words_mono.ini; a test holds the two together.
WordsCommand::WordsCommand() {
  auto& p = benchmark_.pipeline;
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
}

void WordsCommand::declare(CLI::App& command) {
  options_.declare(command);
  command.add_option("--images", benchmark_.images, "Folder of images, shown in the order of their names");
  command.add_option("--reference", benchmark_.reference,
                     "Folder of images that make a map first; --images are then located in it");
  command.add_option("--truth", truthFile_,
                     "Ground truth: query,first,last | image,matches | a,b links | TUM");
  command.add_option("--truth-margin", margin_, "Widens the truth by so many images")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--gap", benchmark_.gap,
                  "Without --reference: answers this near in the sequence are no loops")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--stops", benchmark_.play.stops,
                  "The robot stands still at three points, so many images each")
      ->check(CLI::NonNegativeNumber);
  command
      .add_option("--reverse", benchmark_.play.reverse,
                  "Half-way the robot goes back so many images, and then forward again")
      ->check(CLI::NonNegativeNumber);
}

std::string WordsCommand::readConfig() {
  base::Config config;
  benchmark_.pipeline.bind(config);
  base::IniFile ini = options_.config.empty() ? base::IniFile::parse("", "command line")
                                              : base::IniFile::load(options_.config);
  for (const auto& assignment : options_.overrides) ini.override(assignment);
  config.read(ini);
  benchmark_.pipeline.recognise.threads = options_.threadsInUse();
  return config.dump();
}

int WordsCommand::run(std::ostream& out, std::ostream& err) {
  const std::string settings = readConfig();
  if (options_.dump) {
    out << settings;
    return kOk;
  }
  return runImages(settings, out, err);
}

int WordsCommand::runImages(const std::string& settings, std::ostream& out, std::ostream& err) {
  if (benchmark_.images.empty() || truthFile_.empty())
    throw base::Error("--images and --truth are both needed");
  const auto truth = evaluation::Truth::load(truthFile_, {margin_, 1.0, 1.0});
  claimFolder(options_, settings + "\n# images = " + benchmark_.images +
                            "\n# reference = " + benchmark_.reference + "\n# truth = " + truthFile_ + "\n");
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
