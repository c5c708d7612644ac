// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "views/views_world.h"

#include <cstdint>
#include <string>

namespace engram::apps {

/// Spread of the numbers of views over the orders, (largest - smallest) / mean; and the largest trajectory
/// error over that of the drives in their own order.
struct OrderFigures {
  double viewsSpread = 0, ateRatioMax = 1;
};
OrderFigures orderFigures(const std::vector<OrderedRun>& orders);

/// Sum of a count over all sessions.
int total(const std::vector<ViewSession>& sessions, int ViewSession::*member);

/// Keys: sequences, views, links, weak_links_left, parts, false_links, ate_m, ate_percent (of one round),
/// ate_apart, random_orders {views_spread, ate_ratio_max, runs}, repair, lifelong, kappa_table, recognition,
/// spots.
nlohmann::json toJson(const ViewsResult& result);
std::string toText(const ViewsResult& result);

/// One session of one map.
struct SessionRow {
  std::string map;
  std::size_t number = 1;
  const ViewSession* session = nullptr;
  LocatedShare located = {};
};
/// Of one map; of every map.
std::vector<SessionRow> sessionsOf(const std::string& map, const std::vector<ViewSession>& sessions,
                                   const std::vector<LocatedShare>& located = {});
std::vector<SessionRow> sessionsOf(const ViewsResult& result);

ResultTable tableOf(const std::vector<SessionRow>& sessions);
/// @param tour length of a round [m]
ResultTable tableOf(const std::vector<OrderedRun>& orders, double tour);
ResultTable tableOf(const RepairRun& repair);
ResultTable tableOf(const std::vector<OffsetCell>& offsets);
ResultTable tableOf(const std::vector<SpotRun>& spots);
ResultTable kappaTable(const std::vector<LifelongRun>& runs);

std::string toHtml(const ViewsResult& result, const std::string& settings, std::uint64_t seed);

}  // namespace engram::apps
