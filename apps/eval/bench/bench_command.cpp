// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_command.h"

#include "bench/bench_compare.h"
#include "bench/bench_map.h"
#include "common/table.h"
#include "engram/apps/checks.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/base/text_file.h"
#include "engram/sources/image_folder_source.h"
#include "engram/world/world.h"

#include <algorithm>
#include <filesystem>
#include <numeric>

namespace engram::apps {
namespace {

constexpr const char* kMaps = "bench_maps";  // folder

double meanOf(const std::vector<double>& values) {
  return values.empty()
             ? 0
             : std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Of the sorted values the one that 95 % do not exceed.
double p95Of(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[(values.size() * 95 + 99) / 100 - 1];
}

ResultTable tableOf(const std::vector<BenchFigures>& all) {
  using F = BenchFigures;
  Columns<F> c;
  c.add("places", &F::places).csv().text("places", 8);
  c.add("localise_ms", [](const F& f) { return meanOf(f.localise); }).csv(2).text("localise", -9, fixed(1));
  c.add("localise_p95_ms", [](const F& f) { return p95Of(f.localise); }).csv(2).text("p95", -7, fixed(1));
  c.add("map_ms", [](const F& f) { return meanOf(f.map); }).csv(2).text("map", -7, fixed(1));
  c.add("map_p95_ms", [](const F& f) { return p95Of(f.map); }).csv(2).text("p95", -7, fixed(1));
  c.add("open_ms", &F::open).csv(0).text("open", -8, fixed(0));
  c.add("recall_vs_exact", &F::recall).csv(4).text("recall %", -9, percent(1));
  c.add("right", &F::right).csv().text("right", -6);
  c.add("first_right", &F::firstRight).csv().text("first", -6);
  c.add("exact_right", &F::exactRight).csv().text("exact", -6);
  c.add("rss_bytes", &F::rss).csv().text("memory MB", -10, mega(1));
  c.add("map_bytes", &F::bytes).csv().text("file MB", -9, mega(1));
  return c.table(all);
}

/// Each figure by the number of places.
nlohmann::json figuresOf(const std::vector<BenchFigures>& all) {
  nlohmann::json json;
  for (const BenchFigures& f : all) {
    const std::string key = std::to_string(f.places);
    json["places"].push_back(f.places);
    json["localise_ms"][key] = meanOf(f.localise);
    json["localise_p95_ms"][key] = p95Of(f.localise);
    nlohmann::json& each = json["each_ms"][key];
    each = {{"localise", f.localise}, {"map", f.map}, {"reference", f.reference}};
    for (const auto& [step, times] : f.steps) {
      json["step_ms"][key][step] = meanOf(times);
      if (times.size() == f.localise.size()) each["step " + step] = times;
    }
    json["map_ms"][key] = meanOf(f.map);
    json["map_p95_ms"][key] = p95Of(f.map);
    json["open_ms"][key] = f.open;
    json["recall_vs_exact"][key] = f.recall;
    json["right"][key] = f.right;
    json["first_right"][key] = f.firstRight;
    json["exact_right"][key] = f.exactRight;
    json["rss_bytes"][key] = f.rss;
    json["map_bytes"][key] = f.bytes;
  }
  return json;
}

std::vector<cv::Mat> spread(std::vector<cv::Mat> images, int wanted) {
  if (wanted <= 0 || images.size() <= static_cast<std::size_t>(wanted)) return images;
  std::vector<cv::Mat> chosen;
  for (std::size_t k = 0; k < static_cast<std::size_t>(wanted); ++k)
    chosen.push_back(images[images.size() * k / static_cast<std::size_t>(wanted)]);
  return chosen;
}

}  // namespace

void BenchParams::describe(base::Params& p) {
  p.add("images", images,
        "images that the places are made of, rendered or spread over --images; 0: all of these", {0, 1e5});
  p.add("drive", drive, "images of a drive that is localised, and of another that extends the map", {1, 1e5});
  p.add("singles", singles, "single images whose most similar place is compared with that of exact search",
        {0, 1e5});
  p.add("wheels", wheels, "true: images come with odometry");
}

std::string BenchCommand::description() const {
  return "Time, memory and recall of localising in maps of many places";
}

std::string BenchCommand::examples() const {
  return "  engram-eval bench --places 1000,10000 --out bench --json bench.json\n"
         "  engram-eval bench --places 1000,10000 --out bench --overwrite --compare bench.json\n"
         "  engram-eval bench --images walk --out walk_bench --set recognise.scorer=ltm_match\n";
}

void BenchCommand::declareMore(CLI::App& command) {
  command.add_option("--places", places_, "Sizes of the maps, separated by commas; default 100,1000,10000")
      ->delimiter(',')
      ->check(wholeBetween(2, 1000000));
  command
      .add_option("--images", images_,
                  "Folder of images to make the places of; without it a building is rendered")
      ->type_name("DIR");
  command
      .add_option("--compare", compare_,
                  "Figures of --json of another time: what got slower beyond noise is named, and the exit "
                  "code is 3")
      ->type_name("FILE");
}

void BenchCommand::configure(base::Config& config) {
  pipeline_ = shippedPipeline("fsh_mono.ini");
  if (options().quick) bench_ = {.images = 12, .drive = 5, .singles = 5};
  config.bind("bench", bench_);
  pipeline_.bind(config);
}

void BenchCommand::check() {
  if (!compare_.empty()) {
    before_ = nlohmann::json::parse(base::readTextFile(compare_), nullptr, false);
    if (!before_.is_object()) throw base::Error(compare_ + ": it is no JSON of 'engram-eval bench'");
  }
  if (places_.empty()) places_ = options().quick ? std::vector{50, 300} : std::vector{100, 1000, 10000};
  std::sort(places_.begin(), places_.end());
  places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
}

/// How many places a map has is in its file's name.
std::string BenchCommand::identity() const { return seedAndSize() + "# images = " + images_ + "\n"; }

std::vector<cv::Mat> BenchCommand::rendered(const Workplace& place) const {
  world::WorldParams params;
  params.seed = place.seed;
  const auto world = world::World::preset(options().quick ? "tiny" : "office", params);
  const world::Session tour(world, 1, world::presetEyes("pinhole"), world::DriveKind::kTour, place.threads);
  const std::size_t wanted =
      bench_.images > 0 ? std::min(tour.size(), static_cast<std::size_t>(bench_.images)) : tour.size();
  std::vector<cv::Mat> images(wanted);
  runJobs(place, "rendering", wanted,
          [&](std::size_t k) { images[k] = tour.frame(tour.size() * k / wanted).image; });
  return images;
}

std::vector<cv::Mat> BenchCommand::read() const {
  const auto source = sources::openImageFolder(images_);
  std::vector<cv::Mat> images;
  while (auto frame = source->next()) {
    if (base::interrupted()) throw base::Interrupted("reading " + images_);
    if (!images.empty() && frame->image.size() != images.front().size())
      throw base::Error(images_ + ": " + frame->label + " is of another size than the images before it");
    images.push_back(std::move(frame->image));
  }
  if (!source->problem().empty()) throw base::Error(source->problem());
  return spread(std::move(images), bench_.images);
}

std::vector<cv::Mat> BenchCommand::sourceImages(const Workplace& place) const {
  return images_.empty() ? rendered(place) : read();
}

/// What the maps depend on. They are kept while it stays the same, whatever else is measured on them.
std::string BenchCommand::mapSettings() {
  base::Config config;
  config.bind("camera", pipeline_.camera);
  config.bind("extractor", pipeline_.extractor);
  config.bind("memory", pipeline_.memory);
  config.bind("fsh", pipeline_.fsh);
  config.bind("multi_store", pipeline_.multi_store);
  config.bind("place", pipeline_.place);
  return config.dump() + identity() + "# of them = " + std::to_string(bench_.images) + "\n";
}

/// The folder of the maps, without those that other settings made.
void BenchCommand::prepareMaps(const Workplace& place) {
  const std::filesystem::path folder = place.file(kMaps), note = folder / "made_with.ini";
  const std::string settings = mapSettings();
  if (std::filesystem::exists(note) && base::readTextFile(note.string()) == settings) return;
  std::filesystem::remove_all(folder);
  place.subfolder(kMaps);
  base::writeText(note.string(), settings, true);
}

Findings BenchCommand::measure(const Workplace& place, const std::string&) {
  const BenchImages images(sourceImages(place), place.seed);
  prepareMaps(place);
  std::vector<BenchFigures> all;
  for (const int size : places_) {
    const auto n = static_cast<std::size_t>(size);
    const std::string file = place.file(std::string(kMaps) + "/" + std::to_string(size) + ".engram");
    makeBenchMap(images, pipeline_, n, file, place);
    base::Progress progress(place.progress, "measuring " + std::to_string(size) + " places");
    all.push_back(measureMap(images, pipeline_, {bench_.drive, bench_.singles, bench_.wheels}, n, file));
  }
  const ResultTable table = tableOf(all);
  Findings findings{
      {{"bench.csv", table.toCsv()}}, figuresOf(all), "Processor time [ms]:\n" + table.toText()};
  if (!compare_.empty()) compare(findings);
  return findings;
}

void BenchCommand::compare(Findings& findings) const {
  try {
    const std::vector<SpeedChange> changes = compareSpeed(before_, findings.figures);
    findings.summary += "Compared with " + compare_ + ": " + describe(changes);
    if (std::any_of(changes.begin(), changes.end(), [](const SpeedChange& c) { return c.slower(); }))
      findings.code = kPartial;
  } catch (const nlohmann::json::exception& e) {
    throw base::Error(compare_ + ": " + e.what());
  }
}

}  // namespace engram::apps
