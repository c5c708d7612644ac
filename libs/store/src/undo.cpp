// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "undo.h"

#include "engram/base/error.h"

#include <optional>
#include <string>

namespace engram::store {
namespace {

constexpr RowTable kAllRows[] = {kPlaceRows, kMemoryRows, kViewRows, kEdgeRows, kPathRows};

const std::string kKept = "INSERT INTO undo SELECT CAST($1 AS BIGINT), id, data FROM ";

std::uint64_t number(RowKind kind) { return static_cast<std::uint64_t>(kind); }

std::uint64_t firstNewOf(const MapState& base, RowKind kind) {
  switch (kind) {
    case RowKind::kView:
      return base.nextView;
    case RowKind::kEdge:
      return base.nextEdge;
    case RowKind::kPath:
      return base.path;
    default:
      return base.nextPlace;
  }
}

std::optional<MapState> baseOf(Connection& database) {
  Statement statement(database, "SELECT data FROM undo WHERE kind = $1 AND id = 0");
  statement.bind(1, number(RowKind::kState));
  if (!statement.step()) return std::nullopt;
  return decodeState(statement.blob(0));
}

}  // namespace

void Undo::begin(Connection& database, const MapState& base) {
  clear(database);
  const Blob row = encode(base);
  Statement insert(database, "INSERT INTO undo VALUES ($1, 0, $2)");
  insert.bind(1, number(RowKind::kState)).bind(2, row).run();
  base_ = base;
  active_ = true;
}

bool Undo::load(Connection& database) {
  const auto base = baseOf(database);
  active_ = base.has_value();
  if (!active_) return false;
  base_ = *base;
  Statement statement(database, "SELECT kind, id FROM undo");
  while (statement.step())
    kept_.emplace(static_cast<RowKind>(statement.integer(0)),
                  static_cast<std::uint64_t>(statement.integer(1)));
  return true;
}

void Undo::clear(Connection& database) {
  database.execute("DELETE FROM undo");
  active_ = false;
  kept_.clear();
  unsettled_.clear();
}

std::uint64_t Undo::firstNew(RowKind kind) const { return firstNewOf(base_, kind); }

void Undo::keep(Connection& database, const RowTable& table, std::uint64_t id) {
  if (!active_ || id >= firstNew(table.kind) || !kept_.emplace(table.kind, id).second) return;
  unsettled_.emplace_back(table.kind, id);
  Statement copy(database,
                 (kKept + std::string(table.name) + " WHERE id = $2 ON CONFLICT DO NOTHING").c_str());
  copy.bind(1, number(table.kind)).bind(2, id).run();
}

void Undo::keepAll(Connection& database, const RowTable& table) {
  if (!active_) return;
  Statement copy(database,
                 (kKept + std::string(table.name) + " WHERE id < $2 ON CONFLICT DO NOTHING").c_str());
  copy.bind(1, number(table.kind)).bind(2, firstNew(table.kind)).run();
}

void Undo::settle(bool committed) {
  if (!committed)
    for (const auto& row : unsettled_) kept_.erase(row);
  unsettled_.clear();
}

MapState Undo::takeBack(Connection& database) {
  const auto base = baseOf(database);
  if (!base)
    throw base::Error("map '" + database.path() + "' holds no drive that was cut off: nothing to resume");
  for (const RowTable& table : kAllRows) {
    const std::string name = table.name;
    Statement(database, ("DELETE FROM " + name + " WHERE id >= $1").c_str())
        .bind(1, firstNewOf(*base, table.kind))
        .run();
    Statement(database, ("INSERT INTO " + name +
                         " SELECT id, data FROM undo WHERE kind = $1 ON CONFLICT (id) DO UPDATE SET data = "
                         "excluded.data")
                            .c_str())
        .bind(1, number(table.kind))
        .run();
  }
  return *base;
}

}  // namespace engram::store
