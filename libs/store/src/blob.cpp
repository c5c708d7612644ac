// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "blob.h"

#include <zlib.h>

namespace engram::store {
namespace {

constexpr std::size_t kCrcBytes = 4;

std::uint32_t rowChecksum(std::span<const std::uint8_t> bytes, std::uint64_t rowId) {
  const uLong key = crc32(0, reinterpret_cast<const Bytef*>(&rowId), sizeof rowId);
  return static_cast<std::uint32_t>(crc32_z(key, bytes.data(), bytes.size()));
}

[[noreturn]] void tooShort() { throw base::Error("a row is too short"); }

}  // namespace

std::uint32_t crc32Of(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, bytes.data(), bytes.size()));
}

std::uint32_t crc32Of(const std::string& text) {
  return crc32Of({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
}

void BlobWriter::varint(std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) bytes_.push_back(static_cast<std::uint8_t>(value | 0x80));
  bytes_.push_back(static_cast<std::uint8_t>(value));
}

Blob BlobWriter::seal(std::uint64_t rowId) && {
  put(rowChecksum(bytes_, rowId));
  return std::move(bytes_);
}

BlobReader::BlobReader(std::span<const std::uint8_t> sealed, RowKind kind, std::uint8_t newestVersion,
                       std::uint64_t rowId) {
  if (sealed.size() < 2 + kCrcBytes) tooShort();
  const auto content = sealed.first(sealed.size() - kCrcBytes);
  std::uint32_t crc = 0;
  std::memcpy(&crc, sealed.data() + content.size(), kCrcBytes);
  if (crc != rowChecksum(content, rowId)) throw base::Error("its checksum is wrong");
  if (content[0] != static_cast<std::uint8_t>(kind)) throw base::Error("it is a row of another kind");
  if (content[1] > newestVersion) throw base::Error("it was written by a newer version of Engram");
  rest_ = content.subspan(2);
}

void BlobReader::raw(void* data, std::size_t size) {
  require(size);
  if (size > 0) std::memcpy(data, rest_.data(), size);
  rest_ = rest_.subspan(size);
}

std::string BlobReader::text() {
  std::string s(count(1), '\0');
  raw(s.data(), s.size());
  return s;
}

std::uint64_t BlobReader::varint() {
  std::uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const auto byte = get<std::uint8_t>();
    value |= static_cast<std::uint64_t>(byte & 0x7f) << shift;
    if ((byte & 0x80) == 0) return value;
  }
  throw base::Error("a number in a row is too long");
}

std::size_t BlobReader::count(std::size_t itemBytes) {
  const std::uint64_t n = varint();
  if (n > rest_.size() / itemBytes) tooShort();
  return static_cast<std::size_t>(n);
}

void BlobReader::require(std::size_t size) const {
  if (size > rest_.size()) tooShort();
}

void BlobReader::requireEnd() const {
  if (!rest_.empty()) throw base::Error("a row is too long");
}

}  // namespace engram::store
