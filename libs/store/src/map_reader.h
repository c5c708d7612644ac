// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "codec.h"
#include "connection.h"
#include "engram/map/map_content.h"
#include "engram/types/frame_report.h"

#include <memory>
#include <string>
#include <vector>

namespace engram::store {

/// Reads a map file and checks all of it. Without a list of problems the first one is thrown as base::Error;
/// with one, every problem is added to it and the damaged item left out.
class MapReader {
 public:
  explicit MapReader(Connection& database, std::vector<std::string>* problems = nullptr)
      : database_(database), problems_(problems) {}

  MapState state();
  map::MapHeader header();
  /// @param memories from which each is read when it is asked for; null: all are read now
  map::MapContent content(std::shared_ptr<const map::OnDemand<memory::PlaceMemory>::Source> memories = {},
                          bool withViews = true);
  std::vector<types::FrameReport> records();
  /// Of a map whose format has them.
  std::vector<Drive> drives();
  /// Throws unless the number of the last record fits the totals, for the next one is written behind it.
  void requireLastRecord(const MapState& state);

 private:
  template <class Read>
  void forEachRow(const char* sql, const std::string& what, std::uint64_t expected, Read&& read);
  void problem(const std::string& what);
  void readViews(const MapState& state, map::MapContent& content);
  void readMemories(const MapState& state, map::MapContent& content);
  void checkPicture(const map::View& view);

  Connection& database_;
  std::vector<std::string>* problems_;
};

}  // namespace engram::store
