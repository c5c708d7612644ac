// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/map_file.h"

#include "engram/base/error.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace engram::store {
namespace {

using engram::testing::ringMap;
using ::testing::HasSubstr;

using MapFileTest = StoreTest;

TEST_F(MapFileTest, ReadsBackWhatWasWritten) {
  auto map = ringMap(5);
  map.survey(map::PlaceId(2), engram::testing::planarPose(1, 2, 3));
  const types::FrameReport report = sampleReport();
  {
    MapFile file = MapFile::create(path("a.engram"), sampleHeader());
    file.commit(map, map.takeChanges(), &report);
    file.close();
  }
  const MapFile file = MapFile::open(path("a.engram"), Access::kReadOnly);
  EXPECT_EQ(file.header(), sampleHeader());
  EXPECT_EQ(text(sampleHeader(), file.load().content(), file.records()),
            text(sampleHeader(), map.content(), {report}));
}

}  // namespace
}  // namespace engram::store
