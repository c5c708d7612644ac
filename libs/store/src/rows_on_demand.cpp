// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rows_on_demand.h"

#include "codec.h"
#include "database.h"
#include "derived_rows.h"
#include "engram/base/error.h"
#include "map_reader.h"
#include "server.h"

namespace engram::store {
namespace {

memory::PlaceMemory checkedMemory(std::span<const std::uint8_t> row, std::uint32_t id,
                                  const map::MapHeader& header, const std::string& path) {
  try {
    memory::PlaceMemory memory = decodeMemory(row, id);
    std::string rule = map::brokenRule(memory);
    if (rule.empty()) rule = map::brokenRule(header, memory);
    if (!rule.empty()) throw base::Error(rule);
    return memory;
  } catch (const base::Error& e) {
    throw base::Error("map '" + path + "' is damaged: memory of place " + std::to_string(id) + ": " +
                      e.what());
  }
}

}  // namespace

Connection& RowsOnDemand::database() const {
  if (database_) return *database_;
  std::shared_ptr<Connection> again;
  if (isOnServer(path_))
    again = connectToServer(path_, ServerMode::kReadOnly);
  else
    again = std::make_shared<Database>(path_, Database::Mode::kReadOnly);
  again->beginSnapshot();
  if (MapReader(*again).state().commits != commits_)
    throw base::Error("map '" + path_ + "' was written by another program meanwhile; open it again");
  database_ = std::move(again);
  return *database_;
}

memory::PlaceMemory RowsOnDemand::read(std::uint32_t id) const {
  if (const auto taken = taken_.find(id); taken != taken_.end())
    return checkedMemory(taken->second, id, header_, path_);
  Statement row(database(), "SELECT data FROM memories WHERE id = $1");
  row.bind(1, std::uint64_t{id});
  // One that has gone since, as it cannot, is as bad as an empty one.
  return checkedMemory(row.step() ? row.blob(0) : std::span<const std::uint8_t>(), id, header_, path_);
}

void RowsOnDemand::read(map::DerivedKind kind, const Take& take) const {
  if (version_ < 3 || !taken_.empty()) return;
  try {
    readDerived(database(), kind, basesOf(database(), kind), take);
  } catch (const base::Error&) {
    // A part of the file that cannot be read: what was not handed over is made anew.
  }
}

void RowsOnDemand::letGo() {
  if (!database_) return;
  Statement rows(*database_, "SELECT id, data FROM memories");
  while (rows.step()) {
    const auto data = rows.blob(1);
    taken_.try_emplace(static_cast<std::uint32_t>(rows.integer(0)), data.begin(), data.end());
  }
  database_.reset();
}

void RowsOnDemand::closing(std::uint64_t commits) {
  commits_ = commits;
  database_.reset();
}

}  // namespace engram::store
