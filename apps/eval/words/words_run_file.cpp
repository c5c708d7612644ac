// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_run_file.h"

#include "common/kept_file.h"

namespace engram::apps {
namespace {

using nlohmann::json;

json toJson(const MappingRun::Path& path) {
  json list = json::array();
  for (const auto& p : path) list.push_back({p.x(), p.y()});
  return list;
}

MappingRun::Path pathFrom(const json& list) {
  MappingRun::Path path;
  for (const auto& p : list) path.emplace_back(p.at(0).get<double>(), p.at(1).get<double>());
  return path;
}

}  // namespace

void writeMappingRun(const std::string& path, const MappingRun& run) {
  json closures = json::array(), after = json::object();
  for (const auto& c : run.closures)
    closures.push_back({c.image, c.place, c.placeImage, c.distance, c.turn, c.right, c.kept, c.position.x(),
                        c.position.y()});
  for (const auto& [name, result] : run.after)
    after[name] = {{"ate", result.ate ? json(*result.ate) : json(nullptr)}, {"cpu", result.cpuSeconds}};
  const json file{{"building", run.building},
                  {"length", run.length},
                  {"seconds", run.seconds},
                  {"frames", run.frames},
                  {"images", run.images},
                  {"places", run.places},
                  {"recognised", run.recognised},
                  {"recognised_wrong", run.recognisedWrong},
                  {"closures", closures},
                  {"restored", run.restored},
                  {"ate_odometry", run.ateOdometry},
                  {"ate_before", run.ateBefore},
                  {"ate_map", run.ateMap},
                  {"after", after},
                  {"cpu", run.cpuSeconds},
                  {"truth", toJson(run.truth)},
                  {"odometry", toJson(run.odometry)},
                  {"before", toJson(run.before)},
                  {"relaxed", toJson(run.relaxed)}};
  writeKept(path, file);
}

MappingRun readMappingRun(const std::string& path) {
  return readKept(path, [](const json& file) {
    MappingRun run;
    file.at("building").get_to(run.building);
    file.at("length").get_to(run.length);
    file.at("seconds").get_to(run.seconds);
    file.at("frames").get_to(run.frames);
    file.at("images").get_to(run.images);
    file.at("places").get_to(run.places);
    file.at("recognised").get_to(run.recognised);
    file.at("recognised_wrong").get_to(run.recognisedWrong);
    for (const json& c : file.at("closures"))
      run.closures.push_back(
          {c.at(0), c.at(1), c.at(2), c.at(3), c.at(4), c.at(5), c.at(6), Eigen::Vector2d(c.at(7), c.at(8))});
    file.at("restored").get_to(run.restored);
    file.at("ate_odometry").get_to(run.ateOdometry);
    file.at("ate_before").get_to(run.ateBefore);
    file.at("ate_map").get_to(run.ateMap);
    for (const auto& [name, result] : file.at("after").items()) {
      RelaxerResult& r = run.after[name];
      if (!result.at("ate").is_null()) r.ate = result.at("ate").get<double>();
      result.at("cpu").get_to(r.cpuSeconds);
    }
    file.at("cpu").get_to(run.cpuSeconds);
    run.truth = pathFrom(file.at("truth"));
    run.odometry = pathFrom(file.at("odometry"));
    run.before = pathFrom(file.at("before"));
    run.relaxed = pathFrom(file.at("relaxed"));
    return run;
  });
}

void writeLocalisationRun(const std::string& path, const LocalisationRun& run) {
  json attempts = json::array();
  for (const Attempt& a : run.attempts)
    attempts.push_back({{"start", a.start},
                        {"trials", a.trials},
                        {"located", a.located},
                        {"trackings", a.trackings},
                        {"end", static_cast<int>(a.end)},
                        {"accepted", a.accepted},
                        {"wrong", a.wrong},
                        {"misses", a.misses}});
  const json file{{"setting", run.setting}, {"transition", run.transition}, {"places", run.places},
                  {"shown", run.shown},     {"learned", run.learned},       {"attempts", attempts},
                  {"ms", run.msPerImage}};
  writeKept(path, file);
}

LocalisationRun readLocalisationRun(const std::string& path) {
  return readKept(path, [](const json& file) {
    LocalisationRun run;
    file.at("setting").get_to(run.setting);
    file.at("transition").get_to(run.transition);
    file.at("places").get_to(run.places);
    file.at("shown").get_to(run.shown);
    file.at("learned").get_to(run.learned);
    file.at("ms").get_to(run.msPerImage);
    for (const json& a : file.at("attempts")) {
      Attempt attempt;
      a.at("start").get_to(attempt.start);
      a.at("trials").get_to(attempt.trials);
      a.at("located").get_to(attempt.located);
      a.at("trackings").get_to(attempt.trackings);
      attempt.end = static_cast<Miss>(a.at("end").get<int>());
      a.at("accepted").get_to(attempt.accepted);
      a.at("wrong").get_to(attempt.wrong);
      a.at("misses").get_to(attempt.misses);
      run.attempts.push_back(attempt);
    }
    return run;
  });
}

}  // namespace engram::apps
