// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_codec.h"

#include "engram/base/text.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <memory>
#include <zstd.h>

namespace engram::bags {
namespace {

constexpr std::size_t kStep = std::size_t{1} << 20;  // memory grows by at most this

/// Gathers what a decoder writes, up to a limit.
class GrowingBytes {
 public:
  explicit GrowingBytes(std::uint64_t limit) : limit_(limit) {
    if (limit > kMaxBagRecord)
      throw base::Error("a chunk states " + std::to_string(limit) + " bytes, too many");
  }
  /// Room for more; one byte beyond the limit, so that what is too long shows.
  std::span<std::uint8_t> room() {
    bytes_.resize(std::min<std::uint64_t>(used_ + kStep, limit_ + 1));
    return std::span(bytes_).subspan(used_);
  }
  void used(std::size_t n) {
    used_ += n;
    if (used_ > limit_) throw base::Error("a chunk is longer than it states");
  }
  Bytes finish() {
    bytes_.resize(used_);
    return std::move(bytes_);
  }

 private:
  std::uint64_t limit_;
  std::size_t used_ = 0;
  Bytes bytes_;
};

/// Ends a decoder.
struct FreeCodec {
  void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
  void operator()(LZ4F_dctx* context) const { LZ4F_freeDecompressionContext(context); }
  void operator()(bz_stream* stream) const { BZ2_bzDecompressEnd(stream); }
};

[[noreturn]] void failCodec(const char* name) {
  throw base::Error(std::string("a chunk compressed by ") + name + " is damaged");
}

Bytes unzstd(std::span<const std::uint8_t> bytes, std::uint64_t limit) {
  const std::unique_ptr<ZSTD_DCtx, FreeCodec> context(ZSTD_createDCtx());
  ZSTD_inBuffer in{bytes.data(), bytes.size(), 0};
  GrowingBytes grown(limit);
  for (std::size_t pending = 1; pending != 0 || in.pos < in.size;) {
    const auto room = grown.room();
    ZSTD_outBuffer out{room.data(), room.size(), 0};
    pending = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(pending) != 0 || (pending != 0 && out.pos == 0 && in.pos == in.size)) failCodec("zstd");
    grown.used(out.pos);
  }
  return grown.finish();
}

Bytes unlz4(std::span<const std::uint8_t> bytes, std::uint64_t limit) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) failCodec("lz4");
  const std::unique_ptr<LZ4F_dctx, FreeCodec> context(raw);
  GrowingBytes grown(limit);
  for (std::size_t pending = 1; pending != 0 || !bytes.empty();) {
    const auto room = grown.room();
    std::size_t out = room.size(), in = bytes.size();
    pending = LZ4F_decompress(context.get(), room.data(), &out, bytes.data(), &in, nullptr);
    if (LZ4F_isError(pending) != 0 || (pending != 0 && out == 0 && in == 0)) failCodec("lz4");
    bytes = bytes.subspan(in);
    grown.used(out);
  }
  return grown.finish();
}

Bytes unbz2(std::span<const std::uint8_t> bytes, std::uint64_t limit) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) failCodec("bz2");
  const std::unique_ptr<bz_stream, FreeCodec> ender(&stream);
  stream.next_in = reinterpret_cast<char*>(const_cast<std::uint8_t*>(bytes.data()));
  stream.avail_in = static_cast<unsigned>(bytes.size());
  GrowingBytes grown(limit);
  for (int status = BZ_OK; status != BZ_STREAM_END;) {
    const auto room = grown.room();
    stream.next_out = reinterpret_cast<char*>(room.data());
    stream.avail_out = static_cast<unsigned>(room.size());
    const unsigned before = stream.avail_in;
    status = BZ2_bzDecompress(&stream);
    const std::size_t out = room.size() - stream.avail_out;
    if ((status != BZ_OK && status != BZ_STREAM_END) ||
        (status == BZ_OK && out == 0 && stream.avail_in == before))
      failCodec("bz2");
    grown.used(out);
  }
  return grown.finish();
}

}  // namespace

Bytes decompressChunk(const std::string& compression, std::span<const std::uint8_t> bytes,
                      std::uint64_t size) {
  Bytes out;
  if (compression.empty() || compression == "none")
    out.assign(bytes.begin(), bytes.end());
  else if (compression == "zstd")
    out = unzstd(bytes, size);
  else if (compression == "lz4")
    out = unlz4(bytes, size);
  else if (compression == "bz2")
    out = unbz2(bytes, size);
  else
    throw base::Error("chunks compressed by " + base::quoted(compression) + " cannot be read");
  if (out.size() != size) throw base::Error("a chunk has another size than it states");
  return out;
}

Bytes decompressMessage(Bytes bytes) {
  static constexpr std::uint8_t kZstd[] = {0x28, 0xB5, 0x2F, 0xFD};
  if (bytes.size() < 4 || !std::equal(std::begin(kZstd), std::end(kZstd), bytes.begin())) return bytes;
  return unzstd(bytes, kMaxBagRecord);
}

}  // namespace engram::bags
