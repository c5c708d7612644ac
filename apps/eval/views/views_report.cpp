// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "views/views_report.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace engram::apps {
namespace {

using nlohmann::json;

__attribute__((format(printf, 1, 2))) std::string line(const char* format, ...) {
  char text[512];
  va_list args;
  va_start(args, format);
  std::vsnprintf(text, sizeof text, format, args);
  va_end(args);
  return text;
}

int sum(const std::vector<ViewSession>& sessions, int ViewSession::*member) {
  int total = 0;
  for (const auto& s : sessions) total += s.*member;
  return total;
}

json toJson(const LocatedShare& located) {
  return {{"images", located.images},
          {"accepted", located.accepted},
          {"right", located.right},
          {"share", located.share()},
          {"ms_per_image", located.msPerImage}};
}

json toJson(const ViewSession& s) {
  return {{"frames", s.frames},
          {"views_added", s.viewsAdded},
          {"views_forgotten", s.viewsForgotten},
          {"links", s.links},
          {"false_links", s.falseLinks},
          {"failures", s.failures},
          {"weak_links_made", s.weakMade},
          {"weak_links_left", s.weakLeft},
          {"parts", s.parts},
          {"views", s.views},
          {"edges", s.edges},
          {"map_bytes", s.bytes},
          {"ms_per_image", s.frames > 0 ? 1000 * s.seconds / s.frames : 0.0},
          {"ms_per_view", s.msPerView},
          {"step_ms", s.stepMs},
          {"located", s.located}};
}

json toJson(const LifelongRun& run) {
  json sessions = json::array();
  for (std::size_t k = 0; k < run.sessions.size(); ++k) {
    json session = toJson(run.sessions[k]);
    session["localisation"] = k > 0 ? toJson(run.located[k]) : json(nullptr);
    sessions.push_back(std::move(session));
  }
  return {{"rule", run.rule}, {"ate_m", run.ate}, {"sessions", sessions}};
}

/// Mean share of right images over all sessions but the first.
double locatedMean(const LifelongRun& run) {
  LocatedShare all;
  for (const auto& located : run.located) {
    all.images += located.images;
    all.right += located.right;
  }
  return all.share();
}

std::string lifelongText(const LifelongRun& run) {
  const auto n = run.sessions.size();
  std::string text;
  for (std::size_t k = 0; k < n; ++k) {
    if (k != 0 && (k + 1) % 10 != 0 && k + 1 != n) continue;
    const ViewSession& s = run.sessions[k];
    text += line("  %-6s session %2zu: %4d views, %5.1f MB, %5.1f ms an image, %5.1f a view, located %s\n",
                 run.rule.c_str(), k + 1, s.views, static_cast<double>(s.bytes) / 1e6,
                 s.frames > 0 ? 1000 * s.seconds / s.frames : 0.0, s.msPerView,
                 k == 0 ? "-" : line("%3.0f %%", 100 * run.located[k].share()).c_str());
  }
  return text;
}

}  // namespace

OrderFigures orderFigures(const std::vector<OrderedRun>& orders) {
  OrderFigures figures;
  double least = 1e9, most = 0, mean = 0;
  for (const OrderedRun& run : orders) {
    const double views = run.sessions.back().views;
    least = std::min(least, views);
    most = std::max(most, views);
    mean += views / static_cast<double>(orders.size());
    if (&run != &orders.front())
      figures.ateRatioMax = std::max(figures.ateRatioMax, run.ate / orders.front().ate);
  }
  figures.viewsSpread = mean > 0 ? (most - least) / mean : 0.0;
  return figures;
}

json toJson(const ViewsResult& result) {
  const OrderedRun& first = result.orders.front();
  const ViewSession& end = first.sessions.back();
  const OrderFigures orders = orderFigures(result.orders);
  json runs = json::array(), sessions = json::array(), lifelong = json::array(), kappas = json::array(),
       offsets = json::array(), spots = json::array();
  for (const auto& s : first.sessions) sessions.push_back(toJson(s));
  for (const auto& run : result.orders)
    runs.push_back({{"order", run.order},
                    {"views", run.sessions.back().views},
                    {"weak_links_left", run.sessions.back().weakLeft},
                    {"parts", run.sessions.back().parts},
                    {"false_links", sum(run.sessions, &ViewSession::falseLinks)},
                    {"ate_m", run.ate}});
  for (const auto& run : result.lifelong) lifelong.push_back(toJson(run));
  for (const auto& run : result.kappas) {
    const ViewSession& last = run.sessions.back();
    kappas.push_back({{"kappa", std::stoi(run.rule)},
                      {"views", last.views},
                      {"recall", locatedMean(run)},
                      {"ms_per_view", last.msPerView},
                      {"map_bytes", last.bytes},
                      {"ate_m", run.ate}});
  }
  for (const auto& cell : result.offsets)
    offsets.push_back({{"distance_m", cell.distance},
                       {"angle_deg", std::round(cell.angle * 180 / M_PI)},
                       {"tried", cell.tried},
                       {"recognised", cell.recognised}});
  for (const auto& spot : result.spots)
    spots.push_back(
        {{"name", spot.name}, {"looks", spot.looks}, {"matched", spot.matched}, {"views", spot.views}});
  return {{"sequences", first.sessions.size()},
          {"frames", sum(first.sessions, &ViewSession::frames)},
          {"views", end.views},
          {"links", sum(first.sessions, &ViewSession::links)},
          {"failures", sum(first.sessions, &ViewSession::failures)},
          {"weak_links_made", sum(first.sessions, &ViewSession::weakMade)},
          {"weak_links_left", end.weakLeft},
          {"parts", end.parts},
          {"false_links", sum(first.sessions, &ViewSession::falseLinks)},
          {"tour_m", result.tour},
          {"path_m", first.length},
          {"ate_m", first.ate},
          {"ate_percent", 100 * first.ate / result.tour},
          {"sessions", sessions},
          {"random_orders",
           {{"views_spread", orders.viewsSpread}, {"ate_ratio_max", orders.ateRatioMax}, {"runs", runs}}},
          {"repair",
           {{"session", toJson(result.repair.session)},
            {"covers", result.repair.covers.size()},
            {"links_within", result.repair.linksWithin},
            {"links_across", result.repair.linksAcross},
            {"before", toJson(result.repair.before)},
            {"after", toJson(result.repair.after)}}},
          {"lifelong", lifelong},
          {"kappa_table", kappas},
          {"recognition", offsets},
          {"spots", spots}};
}

std::string toText(const ViewsResult& result) {
  const OrderedRun& first = result.orders.front();
  const ViewSession& end = first.sessions.back();
  std::string text = line(
      "sequences  %zu drives, %.0f m, %d images: %d views, %d links, %d false, %d weak made, %d left, %d "
      "part(s); error %.3f m, %.2f %% of a round\n",
      first.sessions.size(), first.length, sum(first.sessions, &ViewSession::frames), end.views,
      sum(first.sessions, &ViewSession::links), sum(first.sessions, &ViewSession::falseLinks),
      sum(first.sessions, &ViewSession::weakMade), end.weakLeft, end.parts, first.ate,
      100 * first.ate / result.tour);
  const OrderFigures orders = orderFigures(result.orders);
  text += line("orders     %zu random ones: numbers of views differ by %.1f %%, error up to %.2f times\n",
               result.orders.size() - 1, 100 * orders.viewsSpread, orders.ateRatioMax);
  for (const auto& run : result.orders)
    text += line("  %4d views, %d part(s), %d weak left, %d false, error %.3f m\n", run.sessions.back().views,
                 run.sessions.back().parts, run.sessions.back().weakLeft,
                 sum(run.sessions, &ViewSession::falseLinks), run.ate);
  const RepairRun& repair = result.repair;
  text += line(
      "repair     %zu covers: +%d views, %d links (%d to older views), %d false; %d weak links made, %d left "
      "in "
      "the map; located %d of %d before, %d after\n",
      repair.covers.size(), repair.session.viewsAdded, repair.session.links, repair.linksAcross,
      repair.session.falseLinks, repair.session.weakMade, repair.session.weakLeft, repair.before.right,
      repair.before.images, repair.after.right);
  text += "lifelong\n";
  for (const auto& run : result.lifelong) text += lifelongText(run);
  text += "kappa      views   located   ms a view   map [MB]\n";
  for (const auto& run : result.kappas)
    text += line("  %8s %6d   %5.1f %%   %9.1f   %8.2f\n", run.rule.c_str(), run.sessions.back().views,
                 100 * locatedMean(run), run.sessions.back().msPerView,
                 static_cast<double>(run.sessions.back().bytes) / 1e6);
  text += "recognised over distance [m], at 0, 10, 20, 30 degrees\n";
  for (std::size_t k = 0; k + 3 < result.offsets.size(); k += 4) {
    text += line("  %4.2f ", result.offsets[k].distance);
    for (std::size_t j = k; j < k + 4; ++j)
      text += line(" %3.0f %%", 100.0 * result.offsets[j].recognised / std::max(1, result.offsets[j].tried));
    text += "\n";
  }
  text += "spots      views kept at the end, looks that matched\n";
  for (const auto& spot : result.spots)
    text += line("  %-14s %2d   %2d of %d\n", spot.name.c_str(), spot.views.back(), spot.matched, spot.looks);
  return text;
}

std::string sessionsCsv(const ViewsResult& result) {
  std::string csv =
      "run,session,frames,views_added,views_forgotten,links,false_links,failures,weak_made,weak_left,parts,"
      "views,edges,map_bytes,ms_per_image,ms_per_view,located_images,located_right\n";
  const auto add = [&](const std::string& name, std::size_t k, const ViewSession& s, const LocatedShare& l) {
    csv += line("%s,%zu,%d,%d,%d,%d,%d,%d,%d,%d,%d,%d,%d,%llu,%.2f,%.2f,%d,%d\n", name.c_str(), k + 1,
                s.frames, s.viewsAdded, s.viewsForgotten, s.links, s.falseLinks, s.failures, s.weakMade,
                s.weakLeft, s.parts, s.views, s.edges, static_cast<unsigned long long>(s.bytes),
                s.frames > 0 ? 1000 * s.seconds / s.frames : 0.0, s.msPerView, l.images, l.right);
  };
  for (std::size_t k = 0; k < result.orders.size(); ++k)
    for (std::size_t j = 0; j < result.orders[k].sessions.size(); ++j)
      add("order_" + std::to_string(k), j, result.orders[k].sessions[j], {});
  add("repair", 0, result.repair.session, result.repair.after);
  for (const auto* runs : {&result.lifelong, &result.kappas})
    for (const auto& run : *runs)
      for (std::size_t j = 0; j < run.sessions.size(); ++j)
        add((runs == &result.lifelong ? "lifelong_" : "kappa_") + run.rule, j, run.sessions[j],
            run.located[j]);
  return csv;
}

std::string offsetsCsv(const ViewsResult& result) {
  std::string csv = "distance_m,angle_deg,tried,recognised\n";
  for (const auto& cell : result.offsets)
    csv += line("%.2f,%.0f,%d,%d\n", cell.distance, cell.angle * 180 / M_PI, cell.tried, cell.recognised);
  return csv;
}

}  // namespace engram::apps
