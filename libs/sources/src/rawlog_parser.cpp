// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "rawlog_parser.h"

#include "engram/base/error.h"
#include "image_name.h"
#include "rawlog_stamp.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstring>
#include <limits>

namespace engram::sources {
namespace {

constexpr std::size_t kMaxHeader = 130;  // length byte, 120 characters, version
constexpr std::size_t kMaxText = 4096;
constexpr std::int64_t kMaxEncoded = std::int64_t{1} << 28;
constexpr std::size_t kKept = 256;

/// The file does not hold what must stand here.
struct Damage {
  std::string reason;
};

struct FoundHeader {
  std::string name;      // without name space; empty when there is no header
  std::size_t size = 0;  // with the version byte
  int version = 0;
};

bool isNameChar(std::uint8_t c) {
  return std::isalnum(c) != 0 || c == '_' || c == ':' || c == '<' || c == '>';
}

/// MRPT >= 0.5.5: a byte 0x80 + length, the class name (from 1.9 to 2.x with name space), the version.
FoundHeader headerAt(std::span<const std::uint8_t> bytes) {
  if (bytes.empty() || bytes[0] < 0x83 || bytes[0] > 0x80 + 120) return {};
  const std::size_t length = bytes[0] & 0x7F;
  if (bytes.size() < length + 2 || std::isalpha(bytes[1]) == 0) return {};
  const auto name = bytes.subspan(1, length);
  if (!std::all_of(name.begin(), name.end(), isNameChar)) return {};
  std::string text(name.begin(), name.end());
  const auto colon = text.rfind(':');
  if (colon != std::string::npos) text = text.substr(colon + 1);
  return {text, length + 2, bytes[length + 1]};
}

bool startsWith(const std::string& text, const char* prefix) { return text.rfind(prefix, 0) == 0; }

/// Classes that stand beside each other in rawlogs; a nested object is of another class.
bool isEntry(const std::string& name) {
  return startsWith(name, "CObservation") || startsWith(name, "CAction") || name == "CSensoryFrame";
}

bool isPrintable(std::span<const std::uint8_t> bytes) {
  return std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t c) { return c >= 0x20 && c < 0x7F; });
}

std::uint32_t lengthAt(std::span<const std::uint8_t> bytes) {
  std::uint32_t n = 0;
  std::memcpy(&n, bytes.data(), sizeof n);
  return n;
}

/// The text that ends exactly where `bytes` end: the label of the classes that store it last.
std::string textAtEnd(std::span<const std::uint8_t> bytes) {
  for (std::size_t n = 0; n + 4 <= bytes.size(); ++n) {
    const auto at = bytes.subspan(bytes.size() - n - 4);
    if (lengthAt(at) == n && isPrintable(at.subspan(4))) return {at.begin() + 4, at.end()};
  }
  return {};
}

/// Whether a stamp of MRPT between 1990 and 2100 begins at `at`.
bool hasStampAt(std::span<const std::uint8_t> bytes, std::size_t at) {
  if (at > bytes.size() || bytes.size() - at < 8) return false;
  std::uint64_t ticks = 0;
  std::memcpy(&ticks, bytes.data() + at, sizeof ticks);
  return ticks > 122'700'000'000'000'000 && ticks < 157'500'000'000'000'000;
}

/// A text of letters and digits at `at`, with its length before it; empty when there is none.
std::string labelAt(std::span<const std::uint8_t> bytes, std::size_t at) {
  const auto isLabelChar = [](std::uint8_t c) {
    return std::isalnum(c) != 0 || (c != 0 && std::strchr("_-./ ", c) != nullptr);
  };
  const std::uint32_t n = lengthAt(bytes.subspan(at));
  if (n < 1 || n > 64 || n > bytes.size() - at - 4) return {};
  const auto text = bytes.subspan(at + 4, n);
  if (std::isalpha(text[0]) == 0 || !std::all_of(text.begin(), text.end(), isLabelChar)) return {};
  return {text.begin(), text.end()};
}

/// What looks like the label of an object of any class: the last text beside a stamp, else the last of four
/// letters and more that is no name of a type.
std::string guessLabel(std::span<const std::uint8_t> bytes) {
  std::string longest;
  for (std::size_t i = bytes.size() < 5 ? 0 : bytes.size() - 4; i-- > 0;) {
    const std::string label = labelAt(bytes, i);
    if (label.empty()) continue;
    // Range scans have four bytes between.
    const bool stamped = (i >= 8 && hasStampAt(bytes, i - 8)) || (i >= 12 && hasStampAt(bytes, i - 12)) ||
                         hasStampAt(bytes, i + 4 + label.size());
    if (stamped) return label;
    if (longest.empty() && label.size() >= 4 && !label.ends_with("_t")) longest = label;
  }
  return longest;
}

}  // namespace

RawlogParser::RawlogParser(const std::string& path) : path_(path), in_(path) {
  const auto first = in_.peek(kMaxHeader);
  if (!headerAt(first).name.empty()) return;
  if (!in_.error().empty()) throw base::Error(path + ": cannot be read: " + in_.error());
  const bool old = first.size() > 4 && first[0] > 2 && first[0] < 0x80 && first[1] + first[2] + first[3] == 0;
  if (old && first[4] == 'C')
    throw base::Error(path +
                      ": a rawlog of MRPT before 0.5.5 (2008); open and save it with RawLogViewer first");
  throw base::Error(path + ": not a rawlog: it does not begin with the header of an MRPT object");
}

std::optional<Record> RawlogParser::next() {
  if (finished_) return std::nullopt;
  try {
    if (auto record = parseNext()) return record;
    if (!in_.error().empty()) damage_ = describeDamage(in_.error());
  } catch (const Damage& damage) {
    damage_ = describeDamage(in_.error().empty() ? damage.reason : in_.error());
  }
  finished_ = true;
  return std::nullopt;
}

std::string RawlogParser::describeDamage(const std::string& reason) const {
  std::string text = path_ + ": damaged at byte " + std::to_string(in_.position());
  if (in_.compressed()) text += " of the decompressed data";
  return text + (current_.empty() ? "" : ", in or after a " + current_) + ": " + reason;
}

std::optional<Record> RawlogParser::parseNext() {
  for (;;) {
    while (!open_.empty() && open_.back() == 0) {
      expectEndFlag();
      open_.pop_back();
    }
    if (open_.empty() && in_.peek(1).empty()) return std::nullopt;
    const Header header = readHeader();
    current_ = header.name;
    if (!open_.empty()) --open_.back();
    if (header.name == "nullptr") {
      expectEndFlag();
      continue;
    }
    if (header.name != "CSensoryFrame" && header.name != "CActionCollection") return parseObject(header);
    enterCollection(header);
  }
}

void RawlogParser::enterCollection(const Header& header) {
  if (header.name == "CSensoryFrame") {
    if (header.version > 2)
      throw Damage{"version " + std::to_string(header.version) + " of CSensoryFrame is unknown"};
    if (header.version < 2) readValue<std::uint32_t>();   // an identity nobody used
    if (header.version == 0) readValue<std::uint64_t>();  // a stamp; the observations have their own
  }
  const auto n = readValue<std::uint32_t>();
  if (n > 1000000 || open_.size() > 4) throw Damage{"a collection of " + std::to_string(n) + " objects"};
  open_.push_back(n);
  actionTaken_ = false;
  ++counts_[header.name][""];
}

Record RawlogParser::parseObject(const Header& header) {
  Record record = OtherRecord{};
  std::string label;
  if (header.name == "CObservationImage") {
    record = parseImage(header.version);
    label = std::get<ImageRecord>(record).label;
  } else if (header.name == "CObservationStereoImages") {
    record = parseStereo(header.version);
    label = std::get<ImageRecord>(record).label;
  } else if (header.name == "CObservationOdometry") {
    record = parseOdometry(header.version);
    label = std::get<OdometryRecord>(record).label;
  } else if (header.name == "CActionRobotMovement2D") {
    record = parseAction(header.version);
  } else if (header.name == "CObservationComment") {
    record = parseComment(header.version, label);
  } else {
    label = skipWithLabel();
  }
  ++counts_[header.name][label];
  return record;
}

Record RawlogParser::parseImage(int version) {
  if (version > 4) throw Damage{"version " + std::to_string(version) + " of CObservationImage is unknown"};
  ImageRecord record;
  if (version == 4) record.camera = recordedCamera(in_.peek(kMaxText));
  seekImage();
  record.image = readImage();
  record.stamp = version >= 1 ? readStamp() : std::numeric_limits<double>::quiet_NaN();
  if (version == 2 || version == 3) readValue<double>();  // focal length
  if (version >= 3) record.label = readText(kMaxText);
  expectEndFlag();
  return record;
}

Record RawlogParser::parseStereo(int version) {
  if (version > 6)
    throw Damage{"version " + std::to_string(version) + " of CObservationStereoImages is unknown"};
  ImageRecord record;
  const auto cameras = version >= 5 ? recordedPair(in_.peek(kMaxText)) : std::nullopt;
  seekImage();
  record.image = readImage();
  const bool hasDisparity = version >= 6 && readValue<std::uint8_t>() != 0;
  const bool hasRight = version < 6 || readValue<std::uint8_t>() != 0;
  if (hasRight) record.right = readImage();
  if (hasDisparity) readImage();
  record.stereo = hasRight;
  record.stamp = version >= 1 ? readStamp() : std::numeric_limits<double>::quiet_NaN();
  const Tail tail = skipRest();  // the pose of the right camera, the focal length
  if (version >= 4) record.label = textAtEnd(tail.end);
  const auto T_left_right = cameras ? lastPose(tail.end) : std::nullopt;
  if (!T_left_right) return record;
  record.camera = cameras->left;
  record.rightCamera = cameras->right;
  record.rightCamera->T_robot_cam = cameras->left.T_robot_cam * *T_left_right;
  return record;
}

Record RawlogParser::parseOdometry(int version) {
  if (version > 2) throw Damage{"version " + std::to_string(version) + " of CObservationOdometry is unknown"};
  OdometryRecord record;
  record.pose = readPose2();
  record.label = readText(kMaxText);
  record.stamp = readStamp();
  skipRest();  // encoder ticks, velocities
  return record;
}

Record RawlogParser::parseAction(int version) {
  if (version > 7)
    throw Damage{"version " + std::to_string(version) + " of CActionRobotMovement2D is unknown"};
  const bool fromOdometry = version >= 2 && readValue<std::uint32_t>() == 0;
  const std::optional<Pose2> increment = fromOdometry ? std::optional(readPose2()) : readPoseOfPdf();
  const Tail tail = skipRest();  // the motion model, velocities, encoder ticks
  if (!increment || actionTaken_) return OtherRecord{};
  actionTaken_ = true;
  ActionRecord record{std::numeric_limits<double>::quiet_NaN(), *increment};
  if (version >= 6 && tail.end.size() >= 8) {
    std::uint64_t ticks = 0;
    std::memcpy(&ticks, tail.end.data() + tail.end.size() - 8, 8);
    record.stamp = unixSeconds(ticks);
  }
  return record;
}

/// Most comments are for people, and of any length.
Record RawlogParser::parseComment(int version, std::string& label) {
  const auto bytes = in_.peek(4 + kMaxNameComment);
  std::string text;
  if (bytes.size() > 4 && lengthAt(bytes) <= bytes.size() - 4)
    text.assign(bytes.begin() + 4, bytes.begin() + 4 + lengthAt(bytes));
  const std::string name = nameInComment(text);
  if (version != 0 || name.empty()) {
    label = skipWithLabel();
    return OtherRecord{};
  }
  readText(kMaxNameComment);
  const double stamp = readStamp();  // MRPT stores no label with a comment
  expectEndFlag();
  return NameRecord{stamp, name};
}

/// Steps over an object of any class; what looks like its label.
std::string RawlogParser::skipWithLabel() {
  const Tail tail = skipRest();
  const std::string label = guessLabel(tail.end);
  return label.empty() ? guessLabel(tail.head) : label;
}

/// The mean of a CPosePDFGaussian, which it stores first; other densities are not understood.
std::optional<Pose2> RawlogParser::readPoseOfPdf() {
  const Header header = readHeader();
  if (header.name != "CPosePDFGaussian" && header.name != "CPosePDFGaussianInf") return std::nullopt;
  return readPose2();
}

Pose2 RawlogParser::readPose2() {
  const Header header = readHeader();
  if (header.name != "CPose2D" || header.version > 1)
    throw Damage{"a " + header.name + " where a CPose2D must stand"};
  const Pose2 pose = readPose2Body(header.version);
  expectEndFlag();
  return pose;
}

Pose2 RawlogParser::readPose2Body(int version) {
  if (version == 0) {
    const float x = readValue<float>(), y = readValue<float>(), yaw = readValue<float>();
    return {x, y, yaw};
  }
  const double x = readValue<double>(), y = readValue<double>(), yaw = readValue<double>();
  return {x, y, yaw};
}

RawlogParser::Header RawlogParser::readHeader() {
  const FoundHeader found = headerAt(in_.peek(kMaxHeader));
  if (!found.name.empty() && found.name != "nullptr") {
    in_.skip(found.size);
    return {found.name, found.version};
  }
  const auto bytes = in_.peek(kMaxHeader);
  if (bytes.size() >= 8 && bytes[0] == 0x87 && std::memcmp(bytes.data() + 1, "nullptr", 7) == 0) {
    in_.skip(8);  // an empty pointer has no version
    return {"nullptr", 0};
  }
  const bool cut = bytes.empty() ||
                   (bytes.size() < kMaxHeader && bytes[0] > 0x80 && bytes.size() < (bytes[0] & 0x7Fu) + 2);
  throw Damage{cut ? "the file ends in the middle of an object: it is truncated"
                   : "the header of an object is missing"};
}

/// Steps over the camera pose and the calibration, nested objects of known brevity, to the image.
void RawlogParser::seekImage() {
  const auto bytes = in_.peek(kMaxText);
  for (std::size_t i = 0; i + 1 < bytes.size(); ++i)
    if (bytes[i] == kEndFlag && headerAt(bytes.subspan(i + 1)).name == "CImage") return in_.skip(i + 1);
  throw Damage{bytes.size() < kMaxText ? "the file ends in the middle of an object: it is truncated"
                                       : "the image of the observation is missing"};
}

EncodedImage RawlogParser::readImage() {
  const Header header = readHeader();
  if (header.name != "CImage") throw Damage{"a " + header.name + " where a CImage must stand"};
  EncodedImage image;
  readImageBody(header.version, image);
  expectEndFlag();
  return image;
}

void RawlogParser::readImageBody(int version, EncodedImage& image) {
  using Kind = EncodedImage::Kind;
  if (version > 9 && version != 100)
    throw Damage{"version " + std::to_string(version) +
                 " of CImage is unknown; was it written by a newer MRPT?"};
  if (version == 0) {
    image.kind = Kind::kRaw;
    image.size.width = readValue<std::int32_t>();
    image.size.height = readValue<std::int32_t>();
    image.channels = readValue<std::int32_t>();
    image.bottomUp = readValue<std::uint8_t>() == 0;
    if (!plausibleSize(image.size.width, image.size.height) || (image.channels != 1 && image.channels != 3))
      throw Damage{"an image of impossible size"};
    image.bytes = readBytes(readValue<std::uint32_t>());
    image.step = static_cast<std::int64_t>(image.bytes.size()) / image.size.height;
    return;
  }
  if (version == 1) {
    image.kind = Kind::kFile;
    image.bytes = readBytes(readValue<std::uint32_t>());
    return;
  }
  if (version >= 6 && readValue<std::uint8_t>() != 0) {
    image.kind = Kind::kExternal;
    image.path = readText(kMaxText);
    return;
  }
  if (readValue<std::uint8_t>() != 0)
    readColour(version, image);
  else
    readGrey(version, image);
}

void RawlogParser::readColour(int version, EncodedImage& image) {
  using Kind = EncodedImage::Kind;
  image.kind = Kind::kFile;
  if (version >= 7) {
    const std::int64_t width = readValue<std::int32_t>(), height = readValue<std::int32_t>();
    if (width == 0 || height == 0) return void(image.kind = Kind::kNone);
    const bool raw = width < 0 && height < 0;  // MRPT's sign for "not compressed"
    if (!plausibleSize(std::abs(width), std::abs(height)) || (width < 0) != (height < 0))
      throw Damage{"an image of " + std::to_string(width) + " x " + std::to_string(height) + " pixels"};
    image.size = {static_cast<int>(std::abs(width)), static_cast<int>(std::abs(height))};
    if (raw) {
      image.kind = Kind::kRaw;
      image.step = std::int64_t{3} * image.size.width;
      image.bytes = readBytes(image.step * image.size.height);
      return;
    }
  }
  image.bytes = readBytes(readValue<std::uint32_t>());
}

void RawlogParser::readGrey(int version, EncodedImage& image) {
  using Kind = EncodedImage::Kind;
  const std::int64_t width = readValue<std::int32_t>(), height = readValue<std::int32_t>();
  image.bottomUp = readValue<std::int32_t>() != 0;
  const std::int64_t length = readValue<std::int32_t>();
  const int depth = version >= 9 ? readValue<std::int32_t>() : 0;
  if (width == 0 || height == 0) {
    image.kind = Kind::kNone;
  } else {
    if (!plausibleSize(width, height) || length % height != 0 || length / height < width ||
        length / height > 8 * width + 64)
      throw Damage{"an image of " + std::to_string(width) + " x " + std::to_string(height) + " pixels in " +
                   std::to_string(length) + " bytes"};
    image.size = {static_cast<int>(width), static_cast<int>(height)};
    image.step = length / height;  // rows may be padded
    image.channels = 1;
    image.kind = Kind::kRaw;
  }
  bool deflated = version == 3 || (version == 4 && length > 16 * 1024);
  if (version >= 5) deflated = readValue<std::uint8_t>() != 0;
  if (deflated && image.kind == Kind::kRaw) image.kind = Kind::kDeflated;
  image.bytes = readBytes(deflated ? readValue<std::uint32_t>() : length);
  if (depth != 0) {
    image.kind = Kind::kUnsupported;
    image.path = "an image of more than 8 bits per pixel, which Engram cannot use";
  }
}

/// Grows with what the file really holds: a wrong length must not allocate.
std::vector<std::uint8_t> RawlogParser::readBytes(std::int64_t n) {
  if (n < 0 || n > kMaxEncoded) throw Damage{"a block of " + std::to_string(n) + " bytes"};
  std::vector<std::uint8_t> bytes;
  while (static_cast<std::int64_t>(bytes.size()) < n) {
    const std::size_t have = bytes.size();
    const auto part =
        static_cast<std::size_t>(std::min<std::int64_t>(n - static_cast<std::int64_t>(have), 1 << 20));
    bytes.resize(have + part);
    if (!in_.read(bytes.data() + have, part))
      throw Damage{"the file ends in the middle of an image: it is truncated"};
  }
  return bytes;
}

std::string RawlogParser::readText(std::size_t maxLength) {
  const auto n = readValue<std::uint32_t>();
  if (n > maxLength) throw Damage{"a text of " + std::to_string(n) + " characters"};
  std::string text(n, '\0');
  if (!in_.read(text.data(), n)) throw Damage{"the file ends in the middle of an object: it is truncated"};
  return text;
}

template <class T>
T RawlogParser::readValue() {
  T value{};
  if (!in_.read(&value, sizeof value))
    throw Damage{"the file ends in the middle of an object: it is truncated"};
  return value;
}

double RawlogParser::readStamp() { return unixSeconds(readValue<std::uint64_t>()); }

void RawlogParser::expectEndFlag() {
  if (readValue<std::uint8_t>() != kEndFlag) throw Damage{"the end flag of an object is missing"};
}

/// True when an object that ends just before `rest` is followed by what must follow it: the end flags of the
/// collections that are complete with it, then the header of an object or the end of the file.
bool RawlogParser::endsHere(std::span<const std::uint8_t> rest, bool atEnd) const {
  for (std::size_t level = open_.size(); level > 0 && open_[level - 1] == 0; --level) {
    if (rest.empty() || rest[0] != kEndFlag) return false;
    rest = rest.subspan(1);
  }
  const bool allClosed =
      std::all_of(open_.begin(), open_.end(), [](std::uint32_t left) { return left == 0; });
  if (rest.empty()) return atEnd && allClosed;
  return isEntry(headerAt(rest).name);
}

RawlogParser::Tail RawlogParser::skipRest() {
  Tail tail;
  const auto keep = [&tail](std::span<const std::uint8_t> bytes) {
    const auto toHead = bytes.first(std::min(bytes.size(), kKept - tail.head.size()));
    tail.head.insert(tail.head.end(), toHead.begin(), toHead.end());
    tail.end.insert(tail.end.end(), bytes.begin(), bytes.end());
    if (tail.end.size() > kKept) tail.end.erase(tail.end.begin(), tail.end.end() - kKept);
  };
  for (;;) {
    const auto bytes = in_.peek(ByteStream::kWindow / 2);
    const bool atEnd = bytes.size() < ByteStream::kWindow / 2;
    const std::size_t limit = atEnd ? bytes.size() : bytes.size() - kMaxHeader - 8;
    for (std::size_t i = 0; i < limit; ++i) {
      if (bytes[i] != kEndFlag || !endsHere(bytes.subspan(i + 1), atEnd)) continue;
      keep(bytes.first(i));
      in_.skip(i + 1);
      return tail;
    }
    keep(bytes.first(limit));
    in_.skip(limit);
    if (atEnd) throw Damage{"the file ends in the middle of an object: it is truncated"};
  }
}

}  // namespace engram::sources
