// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "place_rows.h"

#include "engram/base/error.h"

#include <cstring>
#include <type_traits>

namespace engram::pipeline {
namespace {

constexpr std::uint8_t kRowVersion = 1;
constexpr std::size_t kMostCells = 1 << 16, kMostDim = 1 << 16, kMostWords = 1 << 16;

class RowBytes {
 public:
  RowBytes() { put(kRowVersion); }
  template <class T>
  void put(T value) {
    static_assert(std::is_arithmetic_v<T>);
    raw(&value, sizeof value);
  }
  void varint(std::uint32_t value) {
    for (; value >= 0x80; value >>= 7) put(static_cast<std::uint8_t>(value | 0x80));
    put(static_cast<std::uint8_t>(value));
  }
  void rows(const types::Descriptors& rows) {
    put(static_cast<std::uint32_t>(rows.size()));
    raw(rows.bytes().data(), rows.bytes().size());
  }
  std::vector<std::uint8_t> take() && { return std::move(bytes_); }

 private:
  void raw(const void* data, std::size_t size) {
    const auto* from = static_cast<const std::uint8_t*>(data);
    bytes_.insert(bytes_.end(), from, from + size);
  }

  std::vector<std::uint8_t> bytes_;
};

class RowReader {
 public:
  explicit RowReader(std::span<const std::uint8_t> row) : rest_(row) {
    if (get<std::uint8_t>() != kRowVersion) throw base::Error("a row of the index is of another version");
  }
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::uint32_t varint() {
    std::uint32_t value = 0;
    for (int shift = 0; shift < 32; shift += 7) {
      const auto byte = get<std::uint8_t>();
      value |= static_cast<std::uint32_t>(byte & 0x7f) << shift;
      if ((byte & 0x80) == 0) return value;
    }
    throw base::Error("a row of the index holds a number that is too large");
  }
  types::Descriptors rows(types::DescriptorKind kind, int dim) {
    types::Descriptors out(kind, dim);
    const auto n = get<std::uint32_t>();
    const auto bytes = take(n * out.rowBytes());
    out.append(std::as_bytes(bytes));
    return out;
  }
  std::span<const std::uint8_t> take(std::size_t size) {
    if (size > rest_.size()) throw base::Error("a row of the index is too short");
    const auto part = rest_.first(size);
    rest_ = rest_.subspan(size);
    return part;
  }
  void requireEnd() const {
    if (!rest_.empty()) throw base::Error("a row of the index is too long");
  }

 private:
  std::span<const std::uint8_t> rest_;
};

}  // namespace

std::vector<std::uint8_t> encodeVocabulary(const PlaceWords& words, std::uint64_t learnAt) {
  RowBytes out;
  out.put(learnAt);
  out.put(static_cast<std::uint8_t>(words.cells().kind()));
  out.put(static_cast<std::uint32_t>(words.cells().dim()));
  out.rows(words.cells());
  for (const types::Descriptors& cell : words.centres()) out.rows(cell);
  return std::move(out).take();
}

StoredVocabulary decodeVocabulary(std::span<const std::uint8_t> row) {
  RowReader in(row);
  const auto learnAt = in.get<std::uint64_t>();
  const auto kind = static_cast<types::DescriptorKind>(in.get<std::uint8_t>());
  const auto dim = in.get<std::uint32_t>();
  const bool known = kind == types::DescriptorKind::kInt8 || kind == types::DescriptorKind::kBinary;
  if (!known || dim == 0 || dim > kMostDim) throw base::Error("words of the index are of an unknown kind");
  types::Descriptors cells = in.rows(kind, static_cast<int>(dim));
  if (cells.empty() || cells.size() > kMostCells) throw base::Error("the index has no words");
  std::vector<types::Descriptors> centres;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    centres.push_back(in.rows(kind, static_cast<int>(dim)));
    if (centres.back().empty()) throw base::Error("a cell of the index has no words");
  }
  in.requireEnd();
  PlaceWords words(std::move(cells), std::move(centres));
  if (words.size() > kMostWords) throw base::Error("the index has too many words");
  return {std::move(words), learnAt};
}

/// Words rise, so their differences are small numbers.
std::vector<std::uint8_t> encodeWords(const StoredWords& place) {
  RowBytes out;
  out.put(place.tag);
  out.put(static_cast<std::uint32_t>(place.words.size()));
  std::uint32_t before = 0;
  for (const PlaceWord& w : place.words) {
    out.varint(w.word - before);
    before = w.word;
  }
  for (const PlaceWord& w : place.words) out.put(w.signature);
  return std::move(out).take();
}

StoredWords decodeWords(std::span<const std::uint8_t> row) {
  RowReader in(row);
  StoredWords place;
  place.tag = in.get<std::uint64_t>();
  const auto n = in.get<std::uint32_t>();
  if (n > row.size()) throw base::Error("a row of the index is too short");
  place.words.resize(n);
  std::uint32_t word = 0;
  for (PlaceWord& w : place.words) w.word = word += in.varint();
  for (PlaceWord& w : place.words) w.signature = in.get<std::uint64_t>();
  in.requireEnd();
  return place;
}

}  // namespace engram::pipeline
