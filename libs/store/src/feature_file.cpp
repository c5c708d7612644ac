// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/feature_file.h"

#include "codec.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"

#include <fstream>
#include <sstream>

namespace engram::store {
namespace {

const std::string kMagic = "engram features 1\n";

std::string readAll(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw base::Error(path + ": cannot be read");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// Takes a number from the front of `rest`. False when it is too short.
bool take(std::span<const std::uint8_t>& rest, std::uint64_t& value) {
  if (rest.size() < sizeof value) return false;
  std::memcpy(&value, rest.data(), sizeof value);
  rest = rest.subspan(sizeof value);
  return true;
}

}  // namespace

void writeFeatureFile(const std::string& path, std::span<const types::Features> images, bool overwrite) {
  std::string bytes = kMagic;
  const auto put = [&](std::uint64_t v) { bytes.append(reinterpret_cast<const char*>(&v), sizeof v); };
  put(images.size());
  for (std::size_t i = 0; i < images.size(); ++i) {
    const Blob row = encodeFeatures(images[i], i);
    put(row.size());
    bytes.append(reinterpret_cast<const char*>(row.data()), row.size());
  }
  base::writeText(path, bytes, overwrite);
}

std::vector<types::Features> readFeatureFile(const std::string& path) {
  const std::string bytes = readAll(path);
  if (bytes.compare(0, kMagic.size(), kMagic) != 0) throw base::Error(path + ": not a file of features");
  std::span rest(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  rest = rest.subspan(kMagic.size());
  std::uint64_t count = 0, size = 0;
  if (!take(rest, count)) throw base::Error(path + ": truncated");
  std::vector<types::Features> images;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!take(rest, size) || size > rest.size())
      throw base::Error(path + ": truncated at image " + std::to_string(i));
    try {
      images.push_back(decodeFeatures(rest.first(size), i));
    } catch (const base::Error& e) {
      throw base::Error(path + ": image " + std::to_string(i) + ": " + e.what());
    }
    rest = rest.subspan(size);
  }
  if (!rest.empty()) throw base::Error(path + ": bytes after the last image");
  return images;
}

std::size_t storedBytes(const memory::PlaceMemory& memory) {
  return encodeMemory(map::PlaceId(0), memory).size();
}

}  // namespace engram::store
