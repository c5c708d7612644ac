// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_codec.h"
#include "bag_formats.h"

#include <map>
#include <zlib.h>

namespace engram::bags {
namespace {

constexpr std::uint8_t kMcapFooter = 2, kMcapSchema = 3, kMcapChannel = 4, kMcapMessage = 5, kMcapChunk = 6,
                       kMcapDataEnd = 15;

/// Read from its beginning and without its summary: one that was never closed is read, too.
class McapBag final : public BagReader {
 public:
  explicit McapBag(const std::string& path) : BagReader(path), file_(path) { file_.skip(8); }
  double progress() const override { return file_.progress(); }

 protected:
  std::optional<BagMessage> read() override {
    while (!ended_) {
      if (at_ < chunk_.size()) {
        BagCursor cursor(std::span<const std::uint8_t>(chunk_).subspan(at_));
        const auto op = cursor.value<std::uint8_t>();
        const auto record = cursor.take(cursor.value<std::uint64_t>());
        at_ = chunk_.size() - cursor.left();
        if (op == kMcapChunk) throw base::Error("a chunk inside a chunk");
        if (auto message = take(op, record)) return message;
      } else if (file_.left() == 0) {
        throw base::Error("the file was never closed");
      } else if (auto message = fromFile()) {
        return message;
      }
    }
    return std::nullopt;
  }

 private:
  std::optional<BagMessage> fromFile() {
    const auto op = file_.value<std::uint8_t>();
    const auto length = file_.value<std::uint64_t>();
    if (op == kMcapDataEnd || op == kMcapFooter) ended_ = true;
    if (op >= kMcapSchema && op <= kMcapChunk) return take(op, file_.take(length));
    file_.skip(length);
    return std::nullopt;
  }

  std::optional<BagMessage> take(std::uint8_t op, std::span<const std::uint8_t> record) {
    BagCursor cursor(record);
    if (op == kMcapSchema) {
      const auto id = cursor.value<std::uint16_t>();
      schemas_[id] = plainType(cursor.text());
    } else if (op == kMcapChannel) {
      addChannel(cursor);
    } else if (op == kMcapChunk) {
      openChunk(cursor);
    } else if (op == kMcapMessage) {
      return message(cursor);
    }
    return std::nullopt;
  }

  void addChannel(BagCursor& cursor) {
    const auto id = cursor.value<std::uint16_t>(), schema = cursor.value<std::uint16_t>();
    if (channels_.contains(id)) return;
    const std::string topic = cursor.text(), encoding = cursor.text();
    // Messages that are neither CDR nor of ROS 1 (JSON, protobuf) are counted, and nothing looks into them.
    const bool known = encoding == "cdr" || encoding == "ros1";
    const std::string type = known ? schemas_[schema] : encoding + ":" + schemas_[schema];
    channels_[id] = indexOf({topic, type, encoding == "cdr", 0});
  }

  void openChunk(BagCursor& cursor) {
    cursor.take(16);  // times of its first and last message
    const auto size = cursor.value<std::uint64_t>();
    const auto sum = cursor.value<std::uint32_t>();
    const std::string compression = cursor.text();
    const auto records = cursor.take(cursor.value<std::uint64_t>());
    chunk_ = decompressChunk(compression, records, size);
    at_ = 0;
    if (sum != 0 && crc32_z(0, chunk_.data(), chunk_.size()) != sum) {
      chunk_.clear();
      throw base::Error("a chunk does not fit its checksum");
    }
  }

  BagMessage message(BagCursor& cursor) const {
    const auto found = channels_.find(cursor.value<std::uint16_t>());
    if (found == channels_.end()) throw base::Error("a message of a channel that is not described");
    cursor.take(4);  // sequence number
    const auto time = cursor.value<std::int64_t>();
    cursor.take(8);  // time of publication
    const auto data = cursor.take(cursor.left());
    return {found->second, time, {data.begin(), data.end()}};
  }

  BagFile file_;
  Bytes chunk_;
  std::size_t at_ = 0;  // in the chunk
  bool ended_ = false;
  std::map<std::uint16_t, std::string> schemas_;
  std::map<std::uint16_t, std::size_t> channels_;
};

}  // namespace

std::unique_ptr<BagReader> openMcapBag(const std::string& path) { return std::make_unique<McapBag>(path); }

}  // namespace engram::bags
