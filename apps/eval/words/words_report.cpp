// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_report.h"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace engram::apps {
namespace {

using nlohmann::json;

template <class... Values>
std::string line(const char* format, Values... values) {
  char text[512];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

json toJson(const MeanStd& m) { return {{"mean", m.mean}, {"std", m.std}}; }

json toJson(const std::array<int, kMisses>& counts) {
  json list = json::object();
  for (std::size_t k = 0; k < kMisses; ++k) list[toString(static_cast<Miss>(k))] = counts[k];
  return list;
}

json toJson(const MappingRun& run) {
  json after = json::object(), seconds = json::object(), closures = json::array();
  for (const auto& [name, result] : run.after) {
    after[name] = result.ate ? json(*result.ate) : json(nullptr);
    seconds[name] = result.cpuSeconds;
  }
  for (const auto& c : run.closures)
    closures.push_back({{"image", c.image},
                        {"place", c.place},
                        {"place_image", c.placeImage},
                        {"distance_m", c.distance},
                        {"turn_deg", c.turn * 180 / M_PI},
                        {"right", c.right},
                        {"kept", c.kept}});
  return {{"building", run.building},
          {"length_m", run.length},
          {"images", run.images},
          {"places", run.places},
          {"recognised", run.recognised},
          {"recognised_wrong", run.recognisedWrong},
          {"true_closures", run.closuresThatAre(true)},
          {"false_closures", run.closuresThatAre(false)},
          {"dropped_closures", run.dropped()},
          {"restored_closures", run.restored},
          {"closures", closures},
          {"ate_odometry_m", run.ateOdometry},
          {"ate_before_m", run.ateBefore},
          {"ate_after_m", after},
          {"ate_map_m", run.ateMap},
          {"relaxation_cpu_seconds", seconds},
          {"cpu_seconds", run.cpuSeconds},
          {"drive_seconds", run.seconds}};
}

json toJson(const LocalisationRun& run) {
  const ProtocolFigures f = figuresOf(run.attempts);
  return {{"setting", run.setting},
          {"transition", run.transition},
          {"attempts", f.attempts},
          {"trials", toJson(f.trials)},
          {"trackings", toJson(f.trackings)},
          {"wrong", f.wrongShare()},
          {"wrong_images", f.wrong},
          {"accepted_images", f.accepted},
          {"never", f.never},
          {"not_accepted", toJson(f.misses)},
          {"ended_by", toJson(f.ends)},
          {"images", run.shown},
          {"images_learned", run.learned},
          {"places", run.places},
          {"ms_per_image", run.msPerImage}};
}

std::string ateText(const RelaxerResult& result) { return result.ate ? line("%.3f", *result.ate) : "-"; }

std::string withStd(const MeanStd& m) {
  return m.count > 0 ? line("%.1f (%.1f)", m.mean, m.std) : std::string("-");
}

}  // namespace

nlohmann::json toJson(const WordsWorldResult& result) {
  json mapping = json::array(), localisation = json::array();
  for (const auto& run : result.mapping) mapping.push_back(toJson(run));
  for (const auto& run : result.localisation) localisation.push_back(toJson(run));
  return {{"mapping", mapping}, {"localisation", localisation}};
}

std::string toText(const WordsWorldResult& result) {
  std::string text =
      line("%-10s %6s %6s %14s %8s   %8s %8s %8s %8s %8s   %s\n", "mapping", "images", "places", "closures",
           "joined", "odometry", "before", "ceres", "duckett", "levmarq", "CPU");
  for (const auto& run : result.mapping) {
    text += line("%-10s %6d %6d %4d + %d false %8d   %7.3fm %7.3fm", run.building.c_str(), run.images,
                 run.places, run.closuresThatAre(true), run.closuresThatAre(false), run.recognised,
                 run.ateOdometry, run.ateBefore);
    for (const auto& name : comparedRelaxers()) text += line(" %7sm", ateText(run.after.at(name)).c_str());
    text += line("   %.0f s for a drive of %.0f s\n", run.cpuSeconds, run.seconds);
  }
  text += line("\n%-10s %-10s %8s %12s %12s %7s %6s %8s\n", "locating", "transition", "attempts", "trials",
               "trackings", "wrong", "never", "ms/image");
  for (const auto& run : result.localisation) {
    const ProtocolFigures f = figuresOf(run.attempts);
    text += line("%-10s %-10s %8d %12s %12s %5.1f %% %6d %8.0f\n", run.setting.c_str(),
                 run.transition.c_str(), f.attempts, withStd(f.trials).c_str(), withStd(f.trackings).c_str(),
                 100 * f.wrongShare(), f.never, run.msPerImage);
  }
  text +=
      line("%-10s %-10s %8d %12s %12s %7s %6s %8d\n", "paper", "indoor", 100, "5 (4)", "5 (3)", "", "", 115);
  text += line("%-10s %-10s %8d %12s %12s %7s %6s %8d\n", "paper", "outdoor", 100, "2 (1)", "12 (10)", "", "",
               644);
  return text;
}

std::string mappingCsv(const WordsWorldResult& result) {
  std::string csv =
      "building,length_m,images,places,recognised,recognised_wrong,true_closures,false_closures,ate_odometry_"
      "m,"
      "ate_before_m,ate_ceres_m,ate_duckett_m,ate_mrpt_levmarq_m,ate_map_m,cpu_seconds,drive_seconds\n";
  for (const auto& run : result.mapping) {
    csv += line("%s,%.2f,%d,%d,%d,%d,%d,%d,%.4f,%.4f", run.building.c_str(), run.length, run.images,
                run.places, run.recognised, run.recognisedWrong, run.closuresThatAre(true),
                run.closuresThatAre(false), run.ateOdometry, run.ateBefore);
    for (const auto& name : comparedRelaxers()) {
      const auto& ate = run.after.at(name).ate;
      csv += ate ? line(",%.4f", *ate) : std::string(",");
    }
    csv += line(",%.4f,%.2f,%.1f\n", run.ateMap, run.cpuSeconds, run.seconds);
  }
  return csv;
}

std::string closuresCsv(const WordsWorldResult& result) {
  std::string csv = "building,image,place,place_image,distance_m,turn_deg,right,kept\n";
  for (const auto& run : result.mapping)
    for (const auto& c : run.closures)
      csv += line("%s,%llu,%u,%llu,%.3f,%.1f,%d,%d\n", run.building.c_str(),
                  static_cast<unsigned long long>(c.image), c.place,
                  static_cast<unsigned long long>(c.placeImage), c.distance, c.turn * 180 / M_PI,
                  c.right ? 1 : 0, c.kept ? 1 : 0);
  return csv;
}

std::string localisationCsv(const WordsWorldResult& result) {
  std::string csv =
      "setting,transition,attempts,trials_mean,trials_std,trackings_mean,trackings_std,accepted_images,"
      "wrong_images,never";
  for (std::size_t k = 0; k < 3; ++k) csv += std::string(",not accepted: ") + toString(static_cast<Miss>(k));
  for (std::size_t k = 0; k < kMisses; ++k)
    csv += std::string(",ended by: ") + toString(static_cast<Miss>(k));
  csv += ",ms_per_image\n";
  for (const auto& run : result.localisation) {
    const ProtocolFigures f = figuresOf(run.attempts);
    csv +=
        line("%s,%s,%d,%.3f,%.3f,%.3f,%.3f,%d,%d,%d", run.setting.c_str(), run.transition.c_str(), f.attempts,
             f.trials.mean, f.trials.std, f.trackings.mean, f.trackings.std, f.accepted, f.wrong, f.never);
    for (std::size_t k = 0; k < 3; ++k) csv += line(",%d", f.misses[k]);
    for (std::size_t k = 0; k < kMisses; ++k) csv += line(",%d", f.ends[k]);
    csv += line(",%.1f\n", run.msPerImage);
  }
  return csv;
}

std::string attemptsCsv(const WordsWorldResult& result) {
  std::string csv = "setting,transition,start,located,trials,trackings,end\n";
  for (const auto& run : result.localisation)
    for (const Attempt& a : run.attempts)
      csv += line("%s,%s,%zu,%d,%d,%d,%s\n", run.setting.c_str(), run.transition.c_str(), a.start,
                  a.located ? 1 : 0, a.trials, a.trackings, toString(a.end));
  return csv;
}

}  // namespace engram::apps
