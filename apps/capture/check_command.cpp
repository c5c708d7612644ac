// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "capture_command.h"
#include "engram/apps/checks.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/progress.h"
#include "engram/capture/stamp_statistics.h"
#include "engram/sources/rawlog_source.h"
#include "stamp_figures.h"

#include <ostream>

namespace engram::apps {
namespace {

class CheckCommand final : public Program {
 public:
  std::string name() const override { return "check"; }
  std::string description() const override {
    return "Rate, jitter and gaps of the images in a rawlog; decodes every one";
  }
  std::string examples() const override { return "  engram-capture check walk.rawlog\n"; }
  void declare(CLI::App& app) override {
    app.add_option("rawlog", path_, "Rawlog to read")->required()->type_name("FILE");
    app.add_option("--sensor-label", params_.sensor_label, "Camera to look at; default: the first one");
    app.add_option("--max-loss", maxLoss_, "Exit with 3 when a larger share of the images is missing")
        ->check(between(0, 1));
    app.add_option("--json", json_, "Write the figures to this file")->type_name("FILE");
    app.add_flag("-q,--quiet", quiet_, "No progress on the terminal");
  }
  int run(std::ostream& out, std::ostream& err) override;

 private:
  std::string path_, json_;
  sources::RawlogParams params_;
  double maxLoss_ = 1.0;
  bool quiet_ = false;
};

int CheckCommand::run(std::ostream& out, std::ostream& err) {
  base::requireWritable(json_);
  const auto source = sources::openRawlog(path_, params_);
  capture::StampStatistics stamps;
  std::size_t images = 0;
  {
    base::Progress progress(quiet_ ? nullptr : &err, "checking");
    while (!base::interrupted()) {
      const auto frame = source->next();
      if (!frame) break;
      stamps.add(frame->stamp);
      progress.update(source->progress(), ++images);
    }
  }
  const std::string problem = source->problem();
  if (images == 0 && !base::interrupted())
    throw base::Error(problem.empty() ? path_ + " holds no images" : problem);

  const auto summary = stamps.summary();
  const auto& stats = source->stats();
  const std::size_t damaged = stats.imagesDamaged + stats.imagesMissing;
  const double loss = static_cast<double>(summary.missing) / static_cast<double>(summary.missing + images);
  out << path_ << ": " << images << " images, " << damaged << " damaged, " << stats.odometry
      << " readings of odometry\n";
  printStamps(out, summary);
  auto json = stampsJson(summary);
  json["frames"] = images;
  json["fps"] = summary.rate;
  json["loss"] = loss;
  json["damaged"] = damaged;
  json["odometry"] = stats.odometry;
  json["problem"] = problem;
  writeJson(json_, json);
  if (!problem.empty()) err << "engram-capture: " << problem << "\n";
  if (loss > maxLoss_) err << "engram-capture: " << 100.0 * loss << " % of the images are missing\n";
  return source->whole() && loss <= maxLoss_ && !base::interrupted() ? kOk : kPartial;
}

}  // namespace

std::unique_ptr<Program> makeCheckCommand() { return std::make_unique<CheckCommand>(); }

}  // namespace engram::apps
