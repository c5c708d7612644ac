// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "odometry/odometry_figures.h"

#include "engram/evaluation/score.h"

#include <map>
#include <numbers>
#include <sstream>

namespace engram::apps {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

struct Counts {
  int keyframes = 0, wideBaseline = 0;
  std::map<std::string, int> failures;  // by reason; the first frame is none
  double inliers = 0;                   // mean of the frames that succeeded
  double length = 0;                    // of the estimated path [m]
  int failed() const {
    int n = 0;
    for (const auto& [reason, times] : failures) n += times;
    return n;
  }
};

Counts countsOf(const OdometryDrive& drive) {
  Counts counts;
  int ok = 0;
  for (const auto& frame : drive.frames) {
    const auto& r = frame.result;
    counts.keyframes += r.newKeyframe;
    counts.wideBaseline += r.ok() && r.wideBaseline;
    counts.inliers += r.ok() ? r.inliers : 0;
    ok += r.ok();
    if (!r.ok() && r.reason != odometry::OdometryReason::kFirst) ++counts.failures[toString(r.reason)];
  }
  counts.inliers /= std::max(1, ok);
  for (const auto& piece : drive.pieces)
    for (std::size_t i = 1; i < piece.size(); ++i)
      counts.length += (piece[i].T_world_body.translation() - piece[i - 1].T_world_body.translation()).norm();
  return counts;
}

evaluation::Percentiles timesOf(const OdometryDrive& drive, double (*of)(const OdometryFrame&)) {
  std::vector<double> times;
  for (const auto& frame : drive.frames) times.push_back(of(frame));
  return evaluation::percentiles(std::move(times));
}

nlohmann::json toJson(const evaluation::Percentiles& p) {
  return {{"mean", p.mean}, {"median", p.median}, {"p95", p.p95}, {"max", p.max}};
}

ResultTable tableOf(const std::vector<evaluation::StretchError>& stretches) {
  using S = evaluation::StretchError;
  Columns<S> c;
  c.add("length_m", &S::length).json();
  c.add("stretches", &S::stretches).json();
  c.add("translation_percent", [](const S& s) { return 100 * s.translation; }).json();
  c.add("rotation_deg_per_m", [](const S& s) { return kDegrees * s.rotation; }).json();
  return c.table(stretches);
}

}  // namespace

ResultTable tableOf(const std::vector<OdometryFrame>& frames) {
  using F = OdometryFrame;
  using R = odometry::OdometryResult;
  Columns<F> c;
  const auto add = [&c](const std::string& name, auto R::*member) -> ColumnForm& {
    return c.add(name, [member](const F& f) { return f.result.*member; });
  };
  c.add("frame", &F::index).csv();
  c.add("stamp", &F::stamp).csv(6);
  c.add("reason", [](const F& f) { return toString(f.result.reason); }).csv();
  add("keyframe", &R::newKeyframe).csv();
  add("wide_baseline", &R::wideBaseline).csv();
  add("points", &R::points).csv();
  add("matches", &R::matches).csv();
  add("inliers", &R::inliers).csv();
  add("sigma_px", &R::sigma).csv(3);
  c.add("rectify_ms", &F::rectifyMs).csv(3);
  c.add("odometry_ms", &F::odometryMs).csv(3);
  return c.table(frames);
}

nlohmann::json figuresJson(const OdometryDrive& drive, const evaluation::Drift& drift) {
  const Counts counts = countsOf(drive);
  nlohmann::json json{
      {"frames", drive.frames.size()},
      {"keyframes", counts.keyframes},
      {"pieces", drive.pieces.size()},
      {"wide_baseline", counts.wideBaseline},
      {"failed", counts.failed()},
      {"failures", counts.failures},
      {"mean_inliers", counts.inliers},
      {"path_m", counts.length},
      {"stretches", tableOf(drift.byLength).toJson()},
      {"ms_per_frame", toJson(timesOf(drive, [](const OdometryFrame& f) { return f.milliseconds(); }))},
      {"rectify_ms", toJson(timesOf(drive, [](const OdometryFrame& f) { return f.rectifyMs; }))}};
  const bool known = drift.measured();
  json["translation_percent"] = known ? nlohmann::json(100 * drift.all.translation) : nlohmann::json();
  json["rotation_deg_per_m"] = known ? nlohmann::json(kDegrees * drift.all.rotation) : nlohmann::json();
  json["true_path_m"] = known ? nlohmann::json(drift.all.length) : nlohmann::json();
  return json;
}

nlohmann::json toJson(const odometry::StereoHealth& health) {
  const auto rows = [](const odometry::RowAgreement& a) {
    return nlohmann::json{{"matches", a.matches}, {"agree", a.agree}};
  };
  return {{"fault", toString(health.fault)},
          {"message", describe(health)},
          {"pairs", health.pairs},
          {"left_blank", health.leftBlank},
          {"right_blank", health.rightBlank},
          {"row_error_px", health.rowError},
          {"together", rows(health.together)},
          {"swapped", rows(health.swapped)},
          {"right_late", rows(health.late)},
          {"right_early", rows(health.early)}};
}

std::string figuresText(const OdometryDrive& drive, const evaluation::Drift& drift) {
  const Counts counts = countsOf(drive);
  std::ostringstream out;
  out << line("%zu frames, %d keyframes, %.1f m in %zu piece%s, %.0f inliers a frame\n", drive.frames.size(),
              counts.keyframes, counts.length, drive.pieces.size(), drive.pieces.size() == 1 ? "" : "s",
              counts.inliers);
  if (counts.wideBaseline > 0) out << counts.wideBaseline << " frames matched by descriptors\n";
  for (const auto& [reason, times] : counts.failures) out << times << " frames failed: " << reason << "\n";
  for (const auto& s : drift.byLength) {
    out << line("  over %3.0f m: %.2f %%, %.3f deg/m (%d stretches)\n", s.length, 100 * s.translation,
                kDegrees * s.rotation, s.stretches);
  }
  if (drift.measured()) {
    out << line("drift: %.2f %%, %.3f deg/m\n", 100 * drift.all.translation, kDegrees * drift.all.rotation);
  }
  const auto ms = timesOf(drive, [](const OdometryFrame& f) { return f.milliseconds(); });
  out << line("%.1f ms a frame (95 %%: %.1f, max %.1f)\n", ms.mean, ms.p95, ms.max);
  return out.str();
}

}  // namespace engram::apps
