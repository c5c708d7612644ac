// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "connection.h"
#include "engram/map/map_content.h"

#include <cstdint>
#include <map>
#include <memory>
#include <string>

namespace engram::store {

/// Reads the rows of a map one by one when they are asked for, after the map was opened. The connection is
/// its MapFile's, whose snapshot holds still. A row that one's own program has changed is not asked for
/// again.
class RowsOnDemand final : public map::OnDemand<memory::PlaceMemory>::Source, public map::Derived {
 public:
  /// @param version of the format of the file
  RowsOnDemand(std::shared_ptr<Connection> database, const map::MapHeader& header, int version)
      : database_(std::move(database)), path_(database_->path()), header_(header), version_(version) {}

  memory::PlaceMemory read(std::uint32_t id) const override;
  void read(map::DerivedKind kind, const Take& take) const override;

  /// Takes all memories along as they are in the file, and needs the connection no longer.
  void letGo();
  /// The connection is going to be closed after so many commits. What is asked for later is read from the
  /// file, if that is still what it was.
  void closing(std::uint64_t commits);

 private:
  Connection& database() const;

  mutable std::shared_ptr<Connection> database_;
  std::string path_;
  map::MapHeader header_;
  int version_;
  std::uint64_t commits_ = 0;
  std::map<std::uint32_t, Blob> taken_;  // memories, by place
};

}  // namespace engram::store
