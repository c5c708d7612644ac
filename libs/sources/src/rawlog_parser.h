// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "byte_stream.h"
#include "engram/sources/odometry_track.h"
#include "image_codec.h"
#include "rawlog_calibration.h"

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace engram::sources {

struct ImageRecord {
  double stamp = 0.0;  ///< [s] since the Unix epoch; NaN when the recorder set none. So in the other records.
  std::string label;
  std::string name;  ///< of its file, where a NameRecord told it
  EncodedImage image, right;
  bool stereo = false;
  std::optional<RecordedCamera> camera, rightCamera;  ///< where the observation has them
};

struct OdometryRecord {
  double stamp = 0.0;
  std::string label;
  Pose2 pose;
};

/// The motion since the action before.
struct ActionRecord {
  double stamp = 0.0;
  Pose2 increment;
};

/// The file that the next image with this stamp came from.
struct NameRecord {
  double stamp = 0.0;
  std::string name;
};

/// An object that Engram has no use for.
struct OtherRecord {};

using Record = std::variant<ImageRecord, OdometryRecord, ActionRecord, NameRecord, OtherRecord>;

/// Cuts a rawlog into its objects without the help of MRPT's own deserialisation: that one believes every
/// length it reads (a flipped bit makes it allocate gigabytes) and lets libjpeg call exit() on a damaged
/// image. Here every length is bounded, images stay encoded, and objects of other classes are stepped over up
/// to the end flag and the header that follow them. Collections (CSensoryFrame, CActionCollection) are opened
/// and their content is returned one by one, so the three layouts of rawlogs look the same to the caller.
class RawlogParser {
 public:
  using Counts = std::map<std::string, std::map<std::string, std::size_t>>;  ///< class -> label -> objects

  /// Throws base::Error when the file cannot be read or does not begin like a rawlog.
  explicit RawlogParser(const std::string& path);

  /// The next object; none at the end or at damage.
  std::optional<Record> next();

  /// Empty after a clean end, else what is wrong and where.
  const std::string& damage() const { return damage_; }
  double progress() const { return in_.progress(); }
  const Counts& counts() const { return counts_; }

 private:
  struct Header {
    std::string name;  ///< without name space
    int version = 0;
  };
  struct Tail {
    std::vector<std::uint8_t> head, end;  ///< the first and the last bytes of what was stepped over
  };

  std::optional<Record> parseNext();
  Record parseObject(const Header& header);
  Record parseImage(int version);
  Record parseStereo(int version);
  Record parseOdometry(int version);
  Record parseAction(int version);
  Record parseComment(int version, std::string& label);
  void enterCollection(const Header& header);

  Header readHeader();
  EncodedImage readImage();
  void readImageBody(int version, EncodedImage& image);
  void readGrey(int version, EncodedImage& image);
  void readColour(int version, EncodedImage& image);
  std::optional<Pose2> readPoseOfPdf();
  Pose2 readPose2();
  Pose2 readPose2Body(int version);
  std::string readText(std::size_t maxLength);
  std::vector<std::uint8_t> readBytes(std::int64_t n);
  double readStamp();
  template <class T>
  T readValue();
  void expectEndFlag();
  void seekImage();
  Tail skipRest();
  std::string skipWithLabel();
  bool endsHere(std::span<const std::uint8_t> rest, bool atEnd) const;
  std::string describeDamage(const std::string& reason) const;

  std::string path_;
  ByteStream in_;
  std::vector<std::uint32_t> open_;  // objects still to come in each open collection
  bool actionTaken_ = false;         // one estimate of the motion per collection is enough
  bool finished_ = false;
  std::string current_;  // class being read, for messages
  std::string damage_;
  Counts counts_;
};

}  // namespace engram::sources
