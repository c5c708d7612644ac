// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "views/views_world.h"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <string>

namespace engram::apps {

/// Spread of the numbers of views over the orders, (largest - smallest) / mean; and the largest trajectory
/// error over that of the drives in their own order.
struct OrderFigures {
  double viewsSpread = 0, ateRatioMax = 1;
};
OrderFigures orderFigures(const std::vector<OrderedRun>& orders);

/// Keys: sequences, views, links, weak_links_left, parts, false_links, ate_m, ate_percent (of one round),
/// random_orders {views_spread, ate_ratio_max, runs}, repair, lifelong, kappa_table, recognition, spots.
nlohmann::json toJson(const ViewsResult& result);
std::string toText(const ViewsResult& result);
/// Every session of every map, a line each.
std::string sessionsCsv(const ViewsResult& result);
std::string offsetsCsv(const ViewsResult& result);

std::string toHtml(const ViewsResult& result, const std::string& settings, std::uint64_t seed);

}  // namespace engram::apps
