// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "views/views_report.h"

#include <algorithm>
#include <cmath>

namespace engram::apps {
namespace {

using nlohmann::json;

json toJson(const LocatedShare& located) {
  return {{"images", located.images},
          {"accepted", located.accepted},
          {"right", located.right},
          {"share", located.share()},
          {"ms_per_image", located.msPerImage}};
}

double msPerImage(const ViewSession& s) { return s.frames > 0 ? 1000 * s.seconds / s.frames : 0.0; }

json toJson(const ViewSession& session) {
  return tableOf(std::vector<SessionRow>{{"", 1, &session}}).toJson().front();
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
                 run.rule.c_str(), k + 1, s.views, static_cast<double>(s.bytes) / 1e6, msPerImage(s),
                 s.msPerView, k == 0 ? "-" : line("%3.0f %%", 100 * run.located[k].share()).c_str());
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

int total(const std::vector<ViewSession>& sessions, int ViewSession::*member) {
  int sum = 0;
  for (const auto& s : sessions) sum += s.*member;
  return sum;
}

ResultTable tableOf(const std::vector<SessionRow>& rows) {
  using R = SessionRow;
  Columns<R> c;
  const auto add = [&c](const std::string& name, auto ViewSession::*member) -> ColumnForm& {
    return c.add(name, [member](const R& r) { return r.session->*member; });
  };
  using S = ViewSession;
  c.add("run", &R::map).csv();
  c.add("session", &R::number).csv().page("drive");
  add("frames", &S::frames).csv().json().page("images");
  add("views_added", &S::viewsAdded).csv().json().page("views added");
  add("views_forgotten", &S::viewsForgotten).csv().json();
  add("links", &S::links).csv().json().page("links");
  add("false_links", &S::falseLinks).csv().json().page("false");
  add("failures", &S::failures).csv().json();
  add("weak_made", &S::weakMade).csv().json("weak_links_made").page("weak made");
  add("weak_left", &S::weakLeft).csv().json("weak_links_left").page("weak left");
  add("parts", &S::parts).csv().json().page("parts");
  add("views", &S::views).csv().json().page("views in the map");
  add("edges", &S::edges).csv().json();
  add("map_bytes", &S::bytes).csv().json();
  c.add("ms_per_image", [](const R& r) { return msPerImage(*r.session); })
      .csv(2)
      .json()
      .page("ms an image", fixed(1));
  add("ms_per_view", &S::msPerView).csv(2).json().page("ms a view", fixed(1));
  c.add("step_ms", [](const R& r) { return json(r.session->stepMs); }).json();
  add("located", &S::located).json();
  c.add("located_images", [](const R& r) { return r.located.images; }).csv();
  c.add("located_right", [](const R& r) { return r.located.right; }).csv();
  return c.table(rows);
}

ResultTable tableOf(const std::vector<OrderedRun>& orders, double tour) {
  using R = OrderedRun;
  const auto end = [](const R& r) -> const ViewSession& { return r.sessions.back(); };
  const auto inWords = [](const R& r) {
    std::string order;
    for (const int k : r.order) order.append(order.empty() ? "" : " ").append(std::to_string(k + 1));
    return order;
  };
  Columns<R> c;
  c.add("order", [](const R& r) { return json(r.order); }).json();
  c.add("", inWords).page("order");
  c.add("views", [end](const R& r) { return end(r).views; }).json().page("views");
  c.add("parts", [end](const R& r) { return end(r).parts; }).json().page("parts");
  c.add("weak_links_left", [end](const R& r) { return end(r).weakLeft; }).json().page("weak left");
  c.add("false_links", [](const R& r) { return total(r.sessions, &ViewSession::falseLinks); })
      .json()
      .page("false links");
  c.add("ate_m", &R::ate).json().page("error [m]", fixed(3));
  c.add("", [tour](const R& r) { return 100 * r.ate / tour; }).page("of a round [%]", fixed(2));
  c.add("ate_apart", &R::apart).json().page("apart [%]", percent(1));
  return c.table(orders);
}

ResultTable tableOf(const RepairRun& repair) {
  using R = RepairRun;
  const auto share = [](const LocatedShare& l) {
    return std::to_string(l.right) + " of " + std::to_string(l.images);
  };
  Columns<R> c;
  c.add("session", [](const R& r) { return toJson(r.session); }).json();
  c.add("covers", [](const R& r) { return r.covers.size(); }).json().page("covers");
  c.add("", [](const R& r) { return r.session.viewsAdded; }).page("views added");
  c.add("links_within", &R::linksWithin).json().page("links within the drive");
  c.add("links_across", &R::linksAcross).json().page("links to older views");
  c.add("", [](const R& r) { return r.session.falseLinks; }).page("false links");
  c.add("", [](const R& r) { return r.session.weakMade; }).page("weak links made");
  c.add("", [](const R& r) { return r.session.weakLeft; }).page("weak links left");
  c.add("before", [](const R& r) { return toJson(r.before); }).json();
  c.add("", [share](const R& r) { return share(r.before); }).page("located before");
  c.add("after", [](const R& r) { return toJson(r.after); }).json();
  c.add("", [share](const R& r) { return share(r.after); }).page("located after");
  return c.table(std::vector{repair});
}

ResultTable kappaTable(const std::vector<LifelongRun>& runs) {
  using R = LifelongRun;
  const auto end = [](const R& r) -> const ViewSession& { return r.sessions.back(); };
  Columns<R> c;
  c.add("kappa", [](const R& r) { return std::stoi(r.rule); }).json();
  c.add("", &R::rule).page("kappa").text("kappa", -10);
  c.add("views", [end](const R& r) { return end(r).views; })
      .json()
      .page("views in the map")
      .text("views", -6);
  c.add("recall", locatedMean).json().page("located [%]", percent(1)).text("located", -9, percent(1, " %"));
  c.add("ms_per_view", [end](const R& r) { return end(r).msPerView; })
      .json()
      .page("CPU a view [ms]", fixed(1))
      .text("ms a view", -11, fixed(1));
  c.add("map_bytes", [end](const R& r) { return end(r).bytes; })
      .json()
      .page("map [MB]", mega(2))
      .text("map [MB]", -10, mega(2));
  c.add("ate_m", &R::ate).json().page("error [m]", fixed(3));
  return c.table(runs);
}

ResultTable tableOf(const std::vector<OffsetCell>& offsets) {
  using O = OffsetCell;
  Columns<O> c;
  c.add("distance_m", &O::distance).csv(2).json();
  c.add("angle_deg", [](const O& o) { return std::round(o.angle * 180 / M_PI); }).csv().json();
  c.add("tried", &O::tried).csv().json();
  c.add("recognised", &O::recognised).csv().json();
  return c.table(offsets);
}

ResultTable tableOf(const std::vector<SpotRun>& spots) {
  using R = SpotRun;
  Columns<R> c;
  c.add("name", &R::name).json();
  c.add("", [](const R& r) { return "  " + r.name; }).text("spots", 16);
  c.add("", [](const R& r) { return r.name + ": " + r.about; }).page("what changes");
  c.add("", [](const R& r) { return r.views.back(); }).page("views kept at the end").text("views", -2);
  c.add("", [](const R& r) {
     return *std::max_element(r.views.begin(), r.views.end());
   }).page("most at once");
  c.add("", [](const R& r) { return line("%d of %d", r.matched, r.looks); }).page("looks that matched");
  c.add("", [](const R& r) { return line("  %2d of %d", r.matched, r.looks); }).text("matched", 0);
  c.add("looks", &R::looks).json();
  c.add("matched", &R::matched).json();
  c.add("views", [](const R& r) { return json(r.views); }).json();
  return c.table(spots);
}

std::vector<SessionRow> sessionsOf(const std::string& map, const std::vector<ViewSession>& sessions,
                                   const std::vector<LocatedShare>& located) {
  std::vector<SessionRow> rows;
  for (std::size_t k = 0; k < sessions.size(); ++k)
    rows.push_back({map, k + 1, &sessions[k], k < located.size() ? located[k] : LocatedShare{}});
  return rows;
}

std::vector<SessionRow> sessionsOf(const ViewsResult& result) {
  std::vector<SessionRow> rows;
  const auto add = [&rows](const std::vector<SessionRow>& more) {
    rows.insert(rows.end(), more.begin(), more.end());
  };
  for (std::size_t k = 0; k < result.orders.size(); ++k)
    add(sessionsOf("order_" + std::to_string(k), result.orders[k].sessions));
  rows.push_back({"repair", 1, &result.repair.session, result.repair.after});
  for (const auto& run : result.lifelong) add(sessionsOf("lifelong_" + run.rule, run.sessions, run.located));
  for (const auto& run : result.kappas) add(sessionsOf("kappa_" + run.rule, run.sessions, run.located));
  return rows;
}

json toJson(const ViewsResult& result) {
  const OrderedRun& first = result.orders.front();
  const ViewSession& end = first.sessions.back();
  const OrderFigures orders = orderFigures(result.orders);
  json lifelong = json::array();
  for (const auto& run : result.lifelong) lifelong.push_back(toJson(run));
  return {{"sequences", first.sessions.size()},
          {"frames", total(first.sessions, &ViewSession::frames)},
          {"views", end.views},
          {"links", total(first.sessions, &ViewSession::links)},
          {"failures", total(first.sessions, &ViewSession::failures)},
          {"weak_links_made", total(first.sessions, &ViewSession::weakMade)},
          {"weak_links_left", end.weakLeft},
          {"parts", end.parts},
          {"false_links", total(first.sessions, &ViewSession::falseLinks)},
          {"tour_m", result.tour},
          {"path_m", first.length},
          {"ate_m", first.ate},
          {"ate_percent", 100 * first.ate / result.tour},
          {"ate_apart", first.apart},
          {"sessions", tableOf(sessionsOf("", first.sessions)).toJson()},
          {"random_orders",
           {{"views_spread", orders.viewsSpread},
            {"ate_ratio_max", orders.ateRatioMax},
            {"runs", tableOf(result.orders, result.tour).toJson()}}},
          {"repair", tableOf(result.repair).toJson().front()},
          {"lifelong", lifelong},
          {"kappa_table", kappaTable(result.kappas).toJson()},
          {"recognition", tableOf(result.offsets).toJson()},
          {"spots", tableOf(result.spots).toJson()}};
}

std::string toText(const ViewsResult& result) {
  const OrderedRun& first = result.orders.front();
  const ViewSession& end = first.sessions.back();
  std::string text = line(
      "sequences  %zu drives, %.0f m, %d images: %d views, %d links, %d false, %d weak made, %d left, %d "
      "part(s); error %.3f m, %.2f %% of a round\n",
      first.sessions.size(), first.length, total(first.sessions, &ViewSession::frames), end.views,
      total(first.sessions, &ViewSession::links), total(first.sessions, &ViewSession::falseLinks),
      total(first.sessions, &ViewSession::weakMade), end.weakLeft, end.parts, first.ate,
      100 * first.ate / result.tour);
  const OrderFigures orders = orderFigures(result.orders);
  text += line("orders     %zu random ones: numbers of views differ by %.1f %%, error up to %.2f times\n",
               result.orders.size() - 1, 100 * orders.viewsSpread, orders.ateRatioMax);
  for (const auto& run : result.orders)
    text += line("  %4d views, %d part(s), %d weak left, %d false, error %.3f m, %.1f %% apart\n",
                 run.sessions.back().views, run.sessions.back().parts, run.sessions.back().weakLeft,
                 total(run.sessions, &ViewSession::falseLinks), run.ate, 100 * run.apart);
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
  text += kappaTable(result.kappas).toText("kappa      views   located   ms a view   map [MB]");
  text += "recognised over distance [m], at 0, 10, 20, 30 degrees\n";
  for (std::size_t k = 0; k + 3 < result.offsets.size(); k += 4) {
    text += line("  %4.2f ", result.offsets[k].distance);
    for (std::size_t j = k; j < k + 4; ++j)
      text += line(" %3.0f %%", 100.0 * result.offsets[j].recognised / std::max(1, result.offsets[j].tried));
    text += "\n";
  }
  text += tableOf(result.spots).toText("spots      views kept at the end, looks that matched");
  return text;
}

}  // namespace engram::apps
