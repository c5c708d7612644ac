// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "schema.h"

#include "codec.h"
#include "diagnosis.h"
#include "engram/base/error.h"
#include "engram/store/map_file.h"
#include "map_reader.h"
#include "schema_check.h"

#include <map>

namespace engram::store {
namespace {

std::string statements(int version) {
  std::string all;
  for (const char* table : kTables) (all += table) += ";\n";
  if (version >= 2)
    for (const char* table : kTablesOfVersion2) (all += table) += ";\n";
  if (version >= 3)
    for (const char* table : kTablesOfVersion3) (all += table) += ";\n";
  return all;
}

void setVersion(Database& database) {
  database.execute(("PRAGMA user_version = " + std::to_string(kFormatVersion)).c_str());
}

}  // namespace

std::vector<Drive> drivesFromRecords(Connection& database) {
  MapReader reader(database);
  std::map<double, int> sessionAt;
  for (const map::PathPoint& point : reader.content().path) sessionAt.emplace(point.stamp, point.session);
  std::vector<Drive> drives;
  std::uint64_t record = 0, lastIndex = 0;
  for (const types::FrameReport& report : reader.records()) {
    if (drives.empty() || report.index <= lastIndex) {
      Drive drive;
      drive.id = static_cast<std::uint32_t>(drives.size());
      drive.firstStamp = report.stamp;
      drive.firstRecord = record;
      drive.finished = true;
      drives.push_back(drive);
    }
    Drive& drive = drives.back();
    const auto session = sessionAt.find(report.stamp);
    if (drive.session < 0 && session != sessionAt.end()) drive.session = session->second;
    drive.lastStamp = report.stamp;
    ++drive.images;
    ++record;
    lastIndex = report.index;
  }
  return drives;
}

void createSchema(Database& database) {
  database.execute(("PRAGMA application_id = " + std::to_string(kApplicationId)).c_str());
  setVersion(database);
  database.execute(statements(kFormatVersion).c_str());
}

int requireMap(Database& database) {
  if (database.number("PRAGMA application_id") != kApplicationId)
    throw base::Error("map '" + database.path() + "': " + whyNoMap(database.path()));
  const auto version = database.number("PRAGMA user_version");
  if (version > kFormatVersion)
    throw base::Error("map '" + database.path() + "' has format " + std::to_string(version) +
                      "; this program reads up to " + std::to_string(kFormatVersion) +
                      ". Use a newer Engram");
  if (version < 1) throw base::Error("map '" + database.path() + "' is damaged: it has no format version");
  requireSchema(database, statements(static_cast<int>(version)).c_str());
  return static_cast<int>(version);
}

namespace {

void nameDrives(Database& database) {
  const std::vector<Drive> drives = drivesFromRecords(database);
  for (const char* table : kTablesOfVersion2) database.execute(table);
  Statement insert(database, "INSERT INTO drives VALUES (?, ?)");
  for (const Drive& drive : drives) {
    const Blob row = encode(drive);
    insert.bind(1, drive.id).bind(2, row).run();
  }
}

}  // namespace

void upgradeSchema(Database& database, int version) {
  if (version >= kFormatVersion) return;
  if (version < 2) nameDrives(database);
  for (const char* table : kTablesOfVersion3) database.execute(table);
  setVersion(database);
}

}  // namespace engram::store
