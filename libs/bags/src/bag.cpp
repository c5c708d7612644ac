// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/bags/bag.h"

#include "bag_formats.h"
#include "engram/base/error.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace engram::bags {
namespace {

namespace fs = std::filesystem;

enum class BagFormat { kNone, kRos1, kMcap, kSqlite };

BagFormat formatOf(const std::string& path) {
  char first[16] = {};
  std::ifstream(path, std::ios::binary).read(first, sizeof first);
  const std::string_view magic(first, sizeof first);
  if (magic.starts_with("#ROSBAG V2.0\n")) return BagFormat::kRos1;
  if (magic.starts_with("\x89MCAP0\r\n")) return BagFormat::kMcap;
  if (magic.starts_with("SQLite format 3")) return BagFormat::kSqlite;
  return BagFormat::kNone;
}

/// The bags in a folder, in the order of their numbers (walk_2.db3 before walk_10.db3).
std::vector<std::string> bagsIn(const std::string& folder) {
  std::vector<std::string> found;
  std::error_code status;
  for (const auto& entry : fs::directory_iterator(folder, status))
    if (const auto e = entry.path().extension(); e == ".db3" || e == ".mcap") found.push_back(entry.path());
  std::sort(found.begin(), found.end(), [](const std::string& a, const std::string& b) {
    return a.size() != b.size() ? a.size() < b.size() : a < b;
  });
  return found;
}

/// The files of one ROS 2 bag, one after another; a topic of the same name is the same topic.
class BagFolder final : public BagReader {
 public:
  BagFolder(const std::string& path, std::vector<std::string> files)
      : BagReader(path), files_(std::move(files)) {}
  double progress() const override {
    const double inside = current_ ? current_->progress() : 0.0;
    return (static_cast<double>(opened_) - (current_ ? 1.0 : 0.0) + inside) /
           static_cast<double>(files_.size());
  }

 protected:
  std::optional<BagMessage> read() override {
    for (;;) {
      if (!current_) {
        if (opened_ == files_.size()) return std::nullopt;
        current_ = openBag(files_[opened_++]);
      }
      if (auto message = current_->next()) {
        message->topic = indexOf(current_->topics()[message->topic]);
        return message;
      }
      for (const auto& topic : current_->topics()) indexOf(topic);
      if (!current_->problem().empty()) throw base::Error(current_->problem());
      current_.reset();
    }
  }

 private:
  std::vector<std::string> files_;
  std::size_t opened_ = 0;
  std::unique_ptr<BagReader> current_;
};

}  // namespace

std::optional<BagMessage> BagReader::next() {
  if (!problem_.empty()) return std::nullopt;
  try {
    auto message = read();
    if (message) ++topics_[message->topic].messages;
    return message;
  } catch (const base::Error& e) {
    const std::string what = e.what();
    problem_ = what.starts_with(path_) ? what : path_ + ": " + what + "; what came before was read";
    return std::nullopt;
  }
}

std::size_t BagReader::indexOf(const BagTopic& topic) {
  const auto same = [&](const BagTopic& t) { return t.name == topic.name && t.type == topic.type; };
  const auto known = std::find_if(topics_.begin(), topics_.end(), same);
  if (known != topics_.end()) return static_cast<std::size_t>(known - topics_.begin());
  topics_.push_back({topic.name, topic.type, topic.cdr, 0});
  return topics_.size() - 1;
}

bool isBag(const std::string& path) {
  std::error_code status;
  if (fs::is_directory(path, status)) return !bagsIn(path).empty();
  return formatOf(path) != BagFormat::kNone;
}

std::unique_ptr<BagReader> openBag(const std::string& path) {
  if (!fs::exists(path)) throw base::Error(path + ": no such file");
  if (fs::is_directory(path)) {
    auto files = bagsIn(path);
    if (files.empty()) throw base::Error(path + ": holds no .db3 and no .mcap");
    return std::make_unique<BagFolder>(path, std::move(files));
  }
  switch (formatOf(path)) {
    case BagFormat::kRos1:
      return openRos1Bag(path);
    case BagFormat::kMcap:
      return openMcapBag(path);
    case BagFormat::kSqlite:
      return openSqliteBag(path);
    case BagFormat::kNone:
      break;
  }
  const bool packed = path.ends_with(".zstd");
  throw base::Error(path + (packed ? ": is compressed as a whole; unpack it first: zstd -d " + path
                                   : ": is no bag of ROS 1 (version 2.0), no .db3 and no .mcap"));
}

std::string plainType(const std::string& type) {
  const auto middle = type.find("/msg/");
  return middle == std::string::npos ? type : type.substr(0, middle) + type.substr(middle + 4);
}

}  // namespace engram::bags
