// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/recorded_drive.h"

#include "engram/apps/json_file.h"
#include "engram/base/atomic_file.h"
#include "engram/base/config.h"
#include "engram/base/error.h"
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/store/feature_file.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <mutex>
#include <numeric>
#include <sstream>

namespace engram::apps {
namespace fs = std::filesystem;
namespace {

using nlohmann::json;

json toJson(const Eigen::Isometry3d& pose) {
  json values = json::array();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) values.push_back(pose(r, c));
  return values;
}

Eigen::Isometry3d poseFrom(const json& values) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) pose(r, c) = values.at(static_cast<std::size_t>(4 * r + c)).get<double>();
  return pose;
}

/// Everything that drives depend on, as text.
std::string describe(const world::World& world, const world::Eyes& eyes, features::ExtractorParams extractor,
                     double noise) {
  world::WorldParams params = world.params();
  base::Config config;
  config.bind("change", params.change);
  config.bind("drive", params.drive);
  config.bind("sensor", params.sensor);
  config.bind("extractor", extractor);
  std::ostringstream text;
  text << config.dump() << world.plan().toText() << cameras::toText(eyes.left) << "seed " << params.seed
       << ", noise " << noise;
  return text.str();
}

bool isRecorded(const std::string& stem, const std::string& madeWith) {
  const json file = readJsonIfAny(stem + ".json");
  return file.is_object() && file.value("made_with", std::string()) == madeWith;
}

void save(const std::string& stem, const RecordedDrive& drive, bool noisy, const std::string& madeWith) {
  json samples = json::array();
  std::vector<types::Features> features;
  for (const auto& s : drive.samples) {
    samples.push_back({{"stamp", s.stamp},
                       {"arc", s.arc},
                       {"world", toJson(s.T_world_robot)},
                       {"odom", toJson(s.T_odom_robot)}});
    features.push_back(s.features);
    if (noisy) features.push_back(s.noisy);
  }
  store::writeFeatureFile(stem + ".features", features, true);
  // Last: a drive counts as recorded from here on.
  base::writeText(stem + ".json",
                  toText(json{{"made_with", madeWith},
                              {"session", drive.session},
                              {"weather", drive.weather},
                              {"tour_length", drive.tourLength},
                              {"noisy", noisy},
                              {"samples", samples}}),
                  true);
}

RecordedDrive load(const std::string& stem) {
  const json file = readJson(stem + ".json");
  const bool noisy = file.at("noisy").get<bool>();
  auto features = store::readFeatureFile(stem + ".features");
  RecordedDrive drive{file.at("session").get<int>(),
                      file.at("weather").get<std::string>(),
                      file.at("tour_length").get<double>(),
                      {}};
  const json& samples = file.at("samples");
  if (features.size() != samples.size() * (noisy ? 2 : 1))
    throw base::Error(stem + ".features holds another number of images than " + stem + ".json");
  for (std::size_t i = 0; i < samples.size(); ++i) {
    Sample s;
    s.stamp = samples[i].at("stamp").get<double>();
    s.arc = samples[i].at("arc").get<double>();
    s.T_world_robot = poseFrom(samples[i].at("world"));
    s.T_odom_robot = poseFrom(samples[i].at("odom"));
    s.features = std::move(features[noisy ? 2 * i : i]);
    if (noisy) s.noisy = std::move(features[2 * i + 1]);
    drive.samples.push_back(std::move(s));
  }
  return drive;
}

}  // namespace

Selection nearestToStations(int stations, double tourLength) {
  const auto choose = [=](const std::vector<double>& arcs) {
    std::vector<std::size_t> chosen;
    for (int k = 0; k < stations && !arcs.empty(); ++k) {
      const double station = tourLength * k / stations;
      const auto distance = [&](double arc) { return std::abs(std::remainder(arc - station, tourLength)); };
      const auto nearest = std::min_element(arcs.begin(), arcs.end(),
                                            [&](double a, double b) { return distance(a) < distance(b); });
      chosen.push_back(static_cast<std::size_t>(nearest - arcs.begin()));
    }
    return chosen;
  };
  return {"nearest to " + std::to_string(stations) + " stations", choose};
}

Selection allImages() {
  const auto choose = [](const std::vector<double>& arcs) {
    std::vector<std::size_t> all(arcs.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return all;
  };
  return {"all", choose};
}

void addNoise(cv::Mat& image, double sigma, std::uint64_t seed) {
  base::Rng rng(seed);
  image = image.clone();
  for (int y = 0; y < image.rows; ++y) {
    auto* row = image.ptr<std::uint8_t>(y);
    for (int x = 0; x < image.cols * image.channels(); ++x)
      row[x] = cv::saturate_cast<std::uint8_t>(row[x] + rng.normal(0, 255 * sigma));
  }
}

types::Features without(const types::Features& features, double share, std::uint64_t seed) {
  base::Rng rng(seed);
  std::vector<int> kept(features.size());
  std::iota(kept.begin(), kept.end(), 0);
  auto removed = static_cast<std::size_t>(std::lround(share * static_cast<double>(kept.size())));
  for (; removed > 0; --removed) {
    const std::size_t at = rng.below(static_cast<std::uint32_t>(kept.size()));
    kept[at] = kept.back();
    kept.pop_back();
  }
  std::sort(kept.begin(), kept.end());
  return features.subset(kept);
}

DriveRecorder::DriveRecorder(const world::World& world, world::Eyes eyes,
                             const features::ExtractorParams& extractor, Options options)
    : world_(world),
      madeWith_(describe(world, eyes, extractor, options.noise)),
      eyes_(std::move(eyes)),
      perception_(eyes_.left, extractor),
      options_(std::move(options)) {}

RecordedDrive DriveRecorder::record(int session, world::DriveKind kind, const Selection& selection,
                                    const std::function<void(std::size_t)>& progress) {
  const bool test = kind == world::DriveKind::kTest;
  const std::string name = (test ? "test_" : "tour_") + std::to_string(session);
  const std::string stem = (fs::path(options_.folder) / name).string();
  const std::string madeWith = madeWith_ + ", images: " + selection.name;
  if (!isRecorded(stem, madeWith))
    save(stem, render(session, kind, selection, progress), options_.noise > 0, madeWith);
  return load(stem);
}

RecordedDrive DriveRecorder::render(int session, world::DriveKind kind, const Selection& selection,
                                    const std::function<void(std::size_t)>& progress) const {
  const world::Session day(world_, session, eyes_, kind, options_.threads);
  std::vector<double> arcs;
  for (const double t : day.drive().imageTimes())
    arcs.push_back(std::fmod(day.drive().arcLengthAt(t), world_.route().length()));
  const auto chosen = selection.choose(arcs);

  RecordedDrive drive{session, day.appearance().inWords(), world_.route().length(), {}};
  drive.samples.resize(chosen.size());
  std::mutex mutex;
  std::size_t done = 0;
  base::parallelFor(chosen.size(), options_.threads, [&](std::size_t k) {
    if (base::interrupted()) return;
    const types::Frame frame = day.frame(chosen[k]);
    Sample& sample = drive.samples[k];
    sample.stamp = frame.stamp;
    sample.arc = arcs[chosen[k]];
    sample.T_world_robot = day.T_world_robot(chosen[k]);
    sample.T_odom_robot = *frame.T_odom_robot;
    sample.features = perception_(frame.image);
    if (options_.noise > 0) {
      cv::Mat noisy = frame.image;
      addNoise(noisy, options_.noise,
               base::Rng(world_.params().seed).fork(static_cast<std::uint64_t>(session) << 32 | k).bits());
      sample.noisy = perception_(noisy);
    }
    const std::lock_guard lock(mutex);
    progress(++done);
  });
  if (base::interrupted()) throw base::Interrupted("recording the drives");
  return drive;
}

}  // namespace engram::apps
