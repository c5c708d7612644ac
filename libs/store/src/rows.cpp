// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rows.h"

#include "exact.h"

#include <string>
#include <utility>

namespace engram::store {

void writeHeader(Database& database, const map::MapHeader& h) {
  Statement insert(database, "INSERT INTO header VALUES (?, ?, ?)");
  const std::pair<const char*, std::string> rows[] = {
      {"engram_version", h.engramVersion},
      {"camera", h.camera},
      {"extractor", h.extractor},
      {"descriptor_kind", std::to_string(static_cast<int>(h.descriptorKind))},
      {"descriptor_dim", std::to_string(h.descriptorDim)},
      {"memory_model", h.memoryModel},
      {"parameters", h.parameters},
      {"first_stamp", exact(h.firstStamp)}};
  for (const auto& [name, value] : rows) {
    const std::string key = name;
    insert.bind(1, key).bind(2, value).bind(3, std::uint64_t{crc32Of(key + '\n' + value)}).run();
  }
}

void writeState(Database& database, const MapState& state) {
  const Blob row = encode(state);
  Statement(database, "INSERT OR REPLACE INTO state VALUES (0, ?)").bind(1, row).run();
}

void writeDrive(Database& database, const Drive& drive) {
  const Blob row = encode(drive);
  Statement(database, "INSERT OR REPLACE INTO drives VALUES (?, ?)").bind(1, drive.id).bind(2, row).run();
}

void writeRecord(Database& database, std::uint64_t id, const std::string& json) {
  Statement record(database, "INSERT INTO records VALUES (?, ?, ?)");
  record.bind(1, id).bind(2, json).bind(3, std::uint64_t{crc32Of(json)}).run();
}

}  // namespace engram::store
