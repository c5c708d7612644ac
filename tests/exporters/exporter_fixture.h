// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "sample_map.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <unistd.h>

namespace engram::exporters {

/// A fresh folder for each test, and a map with every kind of edge, two sessions and strange names.
class ExporterTest : public ::testing::Test {
 protected:
  void SetUp() override {
    char name[] = "/tmp/engram_export_XXXXXX";
    ASSERT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    map_ = testing::ringMap(6);
    map::Place place;
    place.T_map_place = testing::planarPose(14, -2, 1);
    place.createdLabel = "<script>\"&'\xff\x01.png";
    place.session = 1;
    const map::PlaceId extra = map_.addPlace(place);
    const auto link = [&](map::EdgeType type, std::uint32_t a, bool scale) {
      map::Edge e{.type = type, .a = map::PlaceId(a), .b = extra};
      e.T_a_b = testing::relPose(map_.place(e.a).T_map_place.inverse() * place.T_map_place, 0.3);
      e.T_a_b.hasScale = scale;
      map_.addEdge(e);
    };
    link(map::EdgeType::kRecognition, 0, true);
    link(map::EdgeType::kWeak, 2, true);
    link(map::EdgeType::kCompounded, 3, true);
    link(map::EdgeType::kRecognition, 4, false);
    map_.addPathPoint({.session = 1,
                       .stamp = 200.125,
                       .anchor = extra,
                       .T_anchor_robot = testing::planarPose(0.5, 0, 0.1)});
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  static std::string read(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  std::filesystem::path folder_;
  map::TopologicalMap map_;
};

}  // namespace engram::exporters
