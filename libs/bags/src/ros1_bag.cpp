// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bag_codec.h"
#include "bag_formats.h"

#include <map>

namespace engram::bags {
namespace {

/// The fields `name=value` of a header.
class Ros1Fields {
 public:
  explicit Ros1Fields(std::span<const std::uint8_t> header) {
    for (BagCursor cursor(header); !cursor.atEnd();) {
      const std::string field = cursor.text();
      const auto equals = field.find('=');
      if (equals == std::string::npos) throw base::Error("a header holds no field");
      fields_[field.substr(0, equals)] = field.substr(equals + 1);
    }
  }
  std::string text(const std::string& name) const {
    const auto found = fields_.find(name);
    if (found == fields_.end()) throw base::Error("a header without " + name);
    return found->second;
  }
  template <class T>
  T value(const std::string& name) const {
    const std::string bytes = text(name);
    return BagCursor({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}).value<T>();
  }

 private:
  std::map<std::string, std::string> fields_;
};

/// Version 2.0, read from its beginning and without its index: one that was never closed is read, too.
class Ros1Bag final : public BagReader {
 public:
  explicit Ros1Bag(const std::string& path) : BagReader(path), file_(path) { file_.skip(13); }
  double progress() const override { return file_.progress(); }

 protected:
  std::optional<BagMessage> read() override {
    for (;;) {
      if (at_ < chunk_.size()) {
        BagCursor cursor(std::span<const std::uint8_t>(chunk_).subspan(at_));
        const auto header = cursor.sized(), data = cursor.sized();
        at_ = chunk_.size() - cursor.left();
        if (auto message = take(Ros1Fields(header), data, true)) return message;
      } else if (file_.left() == 0) {
        return std::nullopt;
      } else {
        const Bytes header = file_.take(file_.value<std::uint32_t>());
        const Bytes data = file_.take(file_.value<std::uint32_t>());
        if (auto message = take(Ros1Fields(header), data, false)) return message;
      }
    }
  }

 private:
  std::optional<BagMessage> take(const Ros1Fields& fields, std::span<const std::uint8_t> data, bool inChunk) {
    constexpr std::uint8_t kMessage = 2, kChunk = 5, kConnection = 7;
    const auto op = fields.value<std::uint8_t>("op");
    if (op == kMessage) return message(fields, data);
    if (op == kConnection) connect(fields, data);
    if (op == kChunk) {
      if (inChunk) throw base::Error("a chunk inside a chunk");
      chunk_ = decompressChunk(fields.text("compression"), data, fields.value<std::uint32_t>("size"));
      at_ = 0;
    }
    return std::nullopt;
  }

  std::optional<BagMessage> message(const Ros1Fields& fields, std::span<const std::uint8_t> data) const {
    const auto found = connections_.find(fields.value<std::uint32_t>("conn"));
    if (found == connections_.end()) throw base::Error("a message of a connection that is not described");
    const std::string time = fields.text("time");
    BagCursor cursor({reinterpret_cast<const std::uint8_t*>(time.data()), time.size()});
    const std::int64_t seconds = cursor.value<std::uint32_t>();
    return BagMessage{
        found->second, seconds * 1'000'000'000 + cursor.value<std::uint32_t>(), {data.begin(), data.end()}};
  }

  /// Each publisher has a connection of its own; those of a topic are one here.
  void connect(const Ros1Fields& fields, std::span<const std::uint8_t> data) {
    const auto id = fields.value<std::uint32_t>("conn");
    if (connections_.contains(id)) return;
    const BagTopic topic{fields.text("topic"), Ros1Fields(data).text("type"), false, 0};
    connections_[id] = indexOf(topic);
  }

  BagFile file_;
  Bytes chunk_;
  std::size_t at_ = 0;  // in the chunk
  std::map<std::uint32_t, std::size_t> connections_;
};

}  // namespace

std::unique_ptr<BagReader> openRos1Bag(const std::string& path) { return std::make_unique<Ros1Bag>(path); }

}  // namespace engram::bags
