// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/error.h"
#include "engram/store/map_file.h"

#include <sstream>

namespace engram::store {
namespace {

void requireEqual(const std::string& path, const std::string& what, const std::string& stored,
                  const std::string& wanted) {
  if (stored == wanted) return;
  throw base::ConfigError("map '" + path + "' was built with " + what + " '" + stored +
                          "'; this configuration has '" + wanted +
                          "'. Use the configuration that the map was built with, or build a new map");
}

/// The first line in which two texts differ, so that the message stays one line long.
std::pair<std::string, std::string> firstDifference(const std::string& a, const std::string& b) {
  std::istringstream inA(a), inB(b);
  std::string lineA, lineB;
  while (true) {
    lineA.clear();
    lineB.clear();
    const bool hasA = static_cast<bool>(std::getline(inA, lineA));
    const bool hasB = static_cast<bool>(std::getline(inB, lineB));
    if (lineA != lineB || hasA != hasB || !hasA) return {hasA ? lineA : "(end)", hasB ? lineB : "(end)"};
  }
}

}  // namespace

const char* toString(types::DescriptorKind kind) {
  switch (kind) {
    case types::DescriptorKind::kFloat:
      return "float";
    case types::DescriptorKind::kInt8:
      return "int8";
    case types::DescriptorKind::kBinary:
      return "binary";
  }
  return "?";
}

void requireCompatible(const map::MapHeader& stored, const map::MapHeader& wanted, const std::string& path) {
  if (stored.camera != wanted.camera) {
    const auto [a, b] = firstDifference(stored.camera, wanted.camera);
    requireEqual(path, "the camera", a, b);
    requireEqual(path, "the camera", stored.camera, wanted.camera);  // they differ in line ends only
  }
  requireEqual(path, "the extractor", stored.extractor, wanted.extractor);
  requireEqual(path, "descriptors of the kind", toString(stored.descriptorKind),
               toString(wanted.descriptorKind));
  requireEqual(path, "descriptors of dimension", std::to_string(stored.descriptorDim),
               std::to_string(wanted.descriptorDim));
  requireEqual(path, "the memory model", stored.memoryModel, wanted.memoryModel);
}

}  // namespace engram::store
