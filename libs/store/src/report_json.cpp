// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/report_json.h"

#include "engram/base/error.h"
#include "engram/base/json_depth.h"
#include "engram/types/se3.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>
#include <utility>

namespace engram::store {
namespace {

using Json = nlohmann::ordered_json;
using types::FrameReport;
using types::Outcome;

/// A whole number that T can hold: the library would cut it to size.
template <class T>
T whole(const Json& j) {
  const bool fits = j.is_number_unsigned() ? std::in_range<T>(j.get<std::uint64_t>())
                                           : j.is_number_integer() && std::in_range<T>(j.get<std::int64_t>());
  if (!fits) throw base::Error("in a frame record, a whole number is out of range or is none");
  return j.get<T>();
}

Json idToJson(base::PlaceId id) { return id.valid() ? Json(id.value) : Json(nullptr); }

base::PlaceId idFromJson(const Json& j, const char* key) {
  const auto it = j.find(key);
  return it == j.end() || it->is_null() ? base::PlaceId() : base::PlaceId(whole<std::uint32_t>(*it));
}

template <class T>
void read(const Json& j, const char* key, T& value) {
  const auto it = j.find(key);
  if (it == j.end()) return;
  if constexpr (std::is_floating_point_v<T>)
    value = it->is_null() ? std::numeric_limits<T>::quiet_NaN() : it->get<T>();
  else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>)
    value = whole<T>(*it);
  else
    value = it->get<T>();
}

/// Six decimals are more than a probability or a millisecond means, and a third of the text.
double rounded(double value) { return std::round(value * 1e6) / 1e6; }

Outcome outcomeFrom(const std::string& name) {
  for (const Outcome o :
       {Outcome::kSkipped, Outcome::kUnusable, Outcome::kNewPlace, Outcome::kRecognised, Outcome::kRefused})
    if (name == types::toString(o)) return o;
  throw base::Error("unknown outcome '" + name + "' in a frame record");
}

types::AcceptedBy acceptedByFrom(const std::string& name) {
  for (const auto by :
       {types::AcceptedBy::kNothing, types::AcceptedBy::kGeometry, types::AcceptedBy::kSequence})
    if (name == types::toString(by)) return by;
  throw base::Error("unknown accepted_by '" + name + "' in a frame record");
}

Json memoryToJson(const types::MemoryChange& m) {
  return {{"rehearsed", m.rehearsed}, {"added", m.added},     {"pruned", m.pruned},
          {"promoted", m.promoted},   {"demoted", m.demoted}, {"long_term", m.longTerm},
          {"short_term", m.shortTerm}};
}

/// In the plane: the figures that a robot on wheels is asked for. [m], [rad]
Json poseToJson(const types::RobotPose& pose) {
  const Eigen::Isometry3d& T = pose.T_map_robot;
  const auto sigma = [&](int i) { return rounded(std::sqrt(pose.T_place_robot.cov(i, i))); };
  return {{"x", rounded(T(0, 3))},
          {"y", rounded(T(1, 3))},
          {"heading", rounded(std::atan2(T(1, 0), T(0, 0)))},
          {"sigma_along", sigma(0)},
          {"sigma_across", sigma(1)},
          {"sigma_heading", sigma(5)}};
}

void requireObject(const Json& j, const char* what) {
  if (!j.is_object()) throw base::Error(std::string("in a frame record, ") + what + " is not a JSON object");
}

/// As much of it as the record keeps.
types::RobotPose poseFromJson(const Json& j) {
  requireObject(j, "'pose'");
  double x = 0, y = 0, heading = 0, along = 0, across = 0, turn = 0;
  read(j, "x", x);
  read(j, "y", y);
  read(j, "heading", heading);
  read(j, "sigma_along", along);
  read(j, "sigma_across", across);
  read(j, "sigma_heading", turn);
  types::RobotPose pose;
  pose.T_map_robot = Eigen::Translation3d(x, y, 0) * Eigen::AngleAxisd(heading, Eigen::Vector3d::UnitZ());
  types::Vector6d sigma = types::Vector6d::Zero();
  sigma << along, across, 0, 0, 0, turn;
  pose.T_place_robot.cov = sigma.cwiseAbs2().asDiagonal();
  return pose;
}

FrameReport decode(const Json& j) {
  requireObject(j, "the line");
  FrameReport r;
  read(j, "index", r.index);
  read(j, "stamp", r.stamp);
  read(j, "label", r.label);
  if (j.contains("outcome")) r.outcome = outcomeFrom(j.at("outcome").get<std::string>());
  if (j.contains("accepted_by")) r.acceptedBy = acceptedByFrom(j.at("accepted_by").get<std::string>());
  read(j, "reason", r.reason);
  read(j, "features", r.features);
  r.place = idFromJson(j, "place");
  r.bestGuess = idFromJson(j, "best_guess");
  r.rival = idFromJson(j, "rival");
  read(j, "best_guess_interpolated", r.bestGuessInterpolated);
  read(j, "new_place_probability", r.newPlaceProbability);
  if (const auto pose = j.find("pose"); pose != j.end() && !pose->is_null()) r.pose = poseFromJson(*pose);
  for (const Json& h : j.value("hypotheses", Json::array())) {
    requireObject(h, "a hypothesis");
    auto& out = r.hypotheses.emplace_back();
    out.place = idFromJson(h, "place");
    read(h, "similarity", out.similarity);
    read(h, "posterior", out.posterior);
    read(h, "inliers", out.inliers);
  }
  read(j, "closure", r.closure);
  read(j, "closures_dropped", r.closuresDropped);
  read(j, "closures_restored", r.closuresRestored);
  for (const Json& id : j.value("learnt", Json::array()))
    r.learnt.push_back(base::PlaceId(whole<std::uint32_t>(id)));
  const Json m = j.value("memory", Json::object());
  requireObject(m, "'memory'");
  read(m, "rehearsed", r.memory.rehearsed);
  read(m, "added", r.memory.added);
  read(m, "pruned", r.memory.pruned);
  read(m, "promoted", r.memory.promoted);
  read(m, "demoted", r.memory.demoted);
  read(m, "long_term", r.memory.longTerm);
  read(m, "short_term", r.memory.shortTerm);
  const Json times = j.value("times", Json::object());
  for (const auto& [step, ms] : times.items()) r.times.push_back({step, ms.get<double>()});
  read(j, "ms", r.milliseconds);
  if (const auto live = j.find("live"); live != j.end()) {
    requireObject(*live, "'live'");
    auto& l = r.live.emplace();
    read(*live, "latency_ms", l.latency);
    read(*live, "waiting", l.waiting);
    read(*live, "incomplete", l.incomplete);
    read(*live, "missed", l.missed);
    read(*live, "dropped", l.dropped);
  }
  return r;
}

}  // namespace

std::string toJson(const FrameReport& r, bool withTimes) {
  Json j = {{"index", r.index},
            {"stamp", r.stamp},
            {"label", r.label},
            {"outcome", types::toString(r.outcome)},
            {"reason", r.reason},
            {"features", r.features},
            {"place", idToJson(r.place)},
            {"best_guess", idToJson(r.bestGuess)},
            {"best_guess_interpolated", rounded(r.bestGuessInterpolated)},
            {"new_place_probability", rounded(r.newPlaceProbability)}};
  if (r.acceptedBy != types::AcceptedBy::kNothing) j["accepted_by"] = types::toString(r.acceptedBy);
  if (r.rival.valid()) j["rival"] = r.rival.value;
  if (r.pose) j["pose"] = poseToJson(*r.pose);
  j["hypotheses"] = Json::array();
  for (const auto& h : r.hypotheses)
    j["hypotheses"].push_back({{"place", idToJson(h.place)},
                               {"similarity", rounded(h.similarity)},
                               {"posterior", rounded(h.posterior)},
                               {"inliers", h.inliers}});
  j["closure"] = r.closure;
  j["closures_dropped"] = r.closuresDropped;
  j["closures_restored"] = r.closuresRestored;
  j["learnt"] = Json::array();
  for (const auto id : r.learnt) j["learnt"].push_back(id.value);
  j["memory"] = memoryToJson(r.memory);
  if (withTimes) {
    j["times"] = Json::object();
    for (const auto& t : r.times) j["times"][t.step] = rounded(t.milliseconds);
    j["ms"] = rounded(r.milliseconds);
    if (r.live)
      j["live"] = {{"latency_ms", rounded(r.live->latency)},
                   {"waiting", r.live->waiting},
                   {"incomplete", r.live->incomplete},
                   {"missed", r.live->missed},
                   {"dropped", r.live->dropped}};
  }
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

FrameReport reportFromJson(const std::string& line) {
  base::requireShallowJson(line);
  try {
    return decode(Json::parse(line));
  } catch (const Json::exception& e) {
    throw base::Error(std::string("a frame record is not valid: ") + e.what());
  }
}

}  // namespace engram::store
