// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "derived_rows.h"

#include "engram/base/error.h"

#include <optional>

namespace engram::store {
namespace {

constexpr std::uint8_t kDerivedVersion = 1;  // of the frame; what is in it has one of its own

const char* basisTable(map::DerivedKind kind) {
  if (kind == map::DerivedKind::kPlaceWords) return "memories";
  return kind == map::DerivedKind::kSignature ? "views" : nullptr;
}

Blob sealed(const map::DerivedRow& row, std::uint32_t basis) {
  BlobWriter out(static_cast<RowKind>(row.kind), kDerivedVersion);
  out.put(basis);
  out.raw(row.data.data(), row.data.size());
  return std::move(out).seal(row.id);
}

}  // namespace

Checksums basesOf(Connection& connection, map::DerivedKind kind) {
  const char* table = basisTable(kind);
  return table == nullptr ? Checksums{} : connection.checksums(table);
}

void readDerived(Connection& database, map::DerivedKind kind, const Checksums& bases,
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

void checkDerived(Connection& database, std::vector<std::string>& problems) {
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

void writeDerived(Connection& database, std::span<const map::DerivedRow> rows) {
  const Checksums memories = database.checksums("memories"), views = database.checksums("views");
  const auto basisOf = [&](const map::DerivedRow& row) -> std::optional<std::uint32_t> {
    if (basisTable(row.kind) == nullptr) return 0;
    const Checksums& sums = row.kind == map::DerivedKind::kPlaceWords ? memories : views;
    const auto at = sums.find(row.id);
    return at == sums.end() ? std::nullopt : std::optional(at->second);
  };
  Statement put(database, kPutDerived);
  for (const map::DerivedRow& row : rows) {
    const auto basis = basisOf(row);
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
