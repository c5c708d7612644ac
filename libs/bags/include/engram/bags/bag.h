// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace engram::bags {

/// A channel of messages in a bag.
struct BagTopic {
  std::string name;
  std::string type;          ///< "sensor_msgs/Image", whichever ROS it is of
  bool cdr = false;          ///< messages are CDR (ROS 2); else serialised as in ROS 1
  std::size_t messages = 0;  ///< read so far
};

/// A message as it was recorded, not yet decoded.
struct BagMessage {
  std::size_t topic = 0;      ///< index into BagReader::topics()
  std::int64_t received = 0;  ///< when it was recorded [ns since the Unix epoch]
  std::vector<std::uint8_t> data;
};

/// The messages of a bag in the order of the file. Damage ends it; what came before has been delivered.
class BagReader {
 public:
  virtual ~BagReader() = default;

  /// The next message; none at the end, of which problem() tells whether it was a clean one.
  std::optional<BagMessage> next();

  const std::vector<BagTopic>& topics() const { return topics_; }  ///< those that are known so far
  const std::string& problem() const { return problem_; }          ///< names the file; empty without damage
  /// Share of the file read, in [0, 1].
  virtual double progress() const = 0;

 protected:
  explicit BagReader(std::string path) : path_(std::move(path)) {}
  /// Throws base::Error on damage.
  virtual std::optional<BagMessage> read() = 0;

  /// Of a topic in topics(), which it joins when its name and type are new.
  std::size_t indexOf(const BagTopic& topic);

  std::string path_;
  std::vector<BagTopic> topics_;

 private:
  std::string problem_;
};

/// Whether a path is a bag by its first bytes, or a folder of ROS 2 with bags in it.
bool isBag(const std::string& path);

/// Opens ROS 1 `.bag`, ROS 2 `.db3` and `.mcap`, told by their first bytes, or the folder of a ROS 2 bag,
/// whose files are read one after another. Throws base::Error that says what a file is not.
std::unique_ptr<BagReader> openBag(const std::string& path);

/// "sensor_msgs/msg/Image" as "sensor_msgs/Image".
std::string plainType(const std::string& type);

}  // namespace engram::bags
