// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "derived_rows.h"

#include "engram/base/error.h"

#include <sqlite3.h>

#include <optional>

namespace engram::store {
namespace {

constexpr std::uint8_t kDerivedVersion = 1;  // of the frame; what is in it has one of its own

const char* basisTable(map::DerivedKind kind) {
  if (kind == map::DerivedKind::kPlaceWords) return "memories";
  return kind == map::DerivedKind::kSignature ? "views" : nullptr;
}

/// Reads the ends of rows, which are their checksums. The pages of a long row before its last are not read.
class RowEnds {
 public:
  RowEnds(Database& database, const char* table) : database_(database), table_(table) {}
  ~RowEnds() { sqlite3_blob_close(blob_); }
  RowEnds(const RowEnds&) = delete;
  RowEnds& operator=(const RowEnds&) = delete;

  /// None when there is no such row.
  std::optional<std::uint32_t> checksum(std::uint32_t id) {
    const int code = blob_ == nullptr ? sqlite3_blob_open(database_.handle(), "main", table_, "data",
                                                          static_cast<sqlite3_int64>(id), 0, &blob_)
                                      : sqlite3_blob_reopen(blob_, static_cast<sqlite3_int64>(id));
    std::uint32_t sum = 0;
    const int size = code == SQLITE_OK ? sqlite3_blob_bytes(blob_) : 0;
    const bool read = size >= 4 && sqlite3_blob_read(blob_, &sum, sizeof sum,
                                                     size - static_cast<int>(sizeof sum)) == SQLITE_OK;
    if (!read) close();
    return read ? std::optional(sum) : std::nullopt;
  }

 private:
  void close() {
    sqlite3_blob_close(blob_);
    blob_ = nullptr;
  }

  Database& database_;
  const char* table_;
  sqlite3_blob* blob_ = nullptr;
};

Blob sealed(const map::DerivedRow& row, std::uint32_t basis) {
  BlobWriter out(static_cast<RowKind>(row.kind), kDerivedVersion);
  out.put(basis);
  out.raw(row.data.data(), row.data.size());
  return std::move(out).seal(row.id);
}

}  // namespace

Checksums basesOf(Database& database, map::DerivedKind kind) {
  Checksums sums;
  const char* table = basisTable(kind);
  if (table == nullptr) return sums;
  RowEnds ends(database, table);
  Statement ids(database, ("SELECT id FROM " + std::string(table) + " ORDER BY id").c_str());
  while (ids.step()) {
    const auto id = static_cast<std::uint32_t>(ids.integer(0));
    if (const auto sum = ends.checksum(id)) sums.emplace_hint(sums.end(), id, *sum);
  }
  return sums;
}

void readDerived(Database& database, map::DerivedKind kind, const Checksums& bases,
                 const map::Derived::Take& take) {
  Statement rows(database, "SELECT id, data FROM derived WHERE kind = $1 ORDER BY id");
  rows.bind(1, static_cast<std::uint64_t>(kind));
  while (rows.step()) {
    const auto id = static_cast<std::uint32_t>(rows.integer(0));
    try {
      BlobReader in(rows.blob(1), static_cast<RowKind>(kind), kDerivedVersion, id);
      const auto basis = in.get<std::uint32_t>();
      const auto now = bases.find(id);
      if (basisTable(kind) == nullptr || (now != bases.end() && now->second == basis)) take(id, in.rest());
    } catch (const base::Error&) {
      // As good as missing.
    }
  }
}

void checkDerived(Database& database, std::vector<std::string>& problems) {
  Statement rows(database, "SELECT kind, id, data FROM derived");
  while (rows.step()) {
    const std::int64_t kind = rows.integer(0), id = rows.integer(1);
    try {
      if (kind < 0 || kind > 0xff || std::string("WIAN").find(static_cast<char>(kind)) == std::string::npos)
        throw base::Error("it is of an unknown kind");
      BlobReader(rows.blob(2), static_cast<RowKind>(kind), kDerivedVersion, static_cast<std::uint64_t>(id));
    } catch (const base::Error& e) {
      problems.push_back("derived row " + std::to_string(kind) + " " + std::to_string(id) + ": " + e.what() +
                         " (the map is read without it; 'engram-map index' makes it anew)");
    }
  }
}

void writeDerived(Database& database, std::span<const map::DerivedRow> rows) {
  RowEnds memories(database, "memories"), views(database, "views");
  Statement put(database, "INSERT OR REPLACE INTO derived VALUES ($1, $2, $3)");
  for (const map::DerivedRow& row : rows) {
    std::optional<std::uint32_t> basis = 0;
    if (row.kind == map::DerivedKind::kPlaceWords) basis = memories.checksum(row.id);
    if (row.kind == map::DerivedKind::kSignature) basis = views.checksum(row.id);
    if (!basis) continue;
    const Blob data = sealed(row, *basis);
    put.bind(1, static_cast<std::uint64_t>(row.kind)).bind(2, std::uint64_t{row.id}).bind(3, data).run();
  }
  for (const map::DerivedKind kind : {map::DerivedKind::kPlaceWords, map::DerivedKind::kSignature})
    Statement(database, ("DELETE FROM derived WHERE kind = $1 AND id NOT IN (SELECT id FROM " +
                         std::string(basisTable(kind)) + ")")
                            .c_str())
        .bind(1, static_cast<std::uint64_t>(kind))
        .run();
}

}  // namespace engram::store
