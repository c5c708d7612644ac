// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/store/feature_file.h"

#include "sample_map.h"
#include "store_fixture.h"

#include <gtest/gtest.h>

namespace engram::store {
namespace {

class FeatureFileTest : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    const map::TopologicalMap map = engram::testing::ringMap(4, 12);
    for (const auto& [id, place] : map.places()) images_.push_back(place.memory->features);
    images_.insert(images_.begin() + 1, types::Features());  // an image without features
    name_ = path("a.features");
    writeFeatureFile(name_, images_);
  }

  std::vector<types::Features> images_;
  std::string name_;
};

TEST_F(FeatureFileTest, GivesBackEveryBit) {
  const auto read = readFeatureFile(name_);
  ASSERT_EQ(read.size(), images_.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].descriptors.bytes(), images_[i].descriptors.bytes());
    EXPECT_EQ(read[i].bearings, images_[i].bearings);
    ASSERT_EQ(read[i].size(), images_[i].size());
    for (std::size_t k = 0; k < read[i].size(); ++k) {
      EXPECT_EQ(read[i].keypoints[k].x, images_[i].keypoints[k].x);
      EXPECT_EQ(read[i].keypoints[k].response, images_[i].keypoints[k].response);
      EXPECT_EQ(read[i].keypoints[k].sign, images_[i].keypoints[k].sign);
    }
  }
}

TEST_F(FeatureFileTest, OverwritesOnlyWhenAsked) {
  EXPECT_THROW(writeFeatureFile(name_, {}), base::Error);
  EXPECT_EQ(readFeatureFile(name_).size(), images_.size());
  writeFeatureFile(name_, {}, true);
  EXPECT_TRUE(readFeatureFile(name_).empty());
}

TEST_F(FeatureFileTest, RefusesEveryDamage) {
  const std::string good = fileBytes(name_);
  for (std::size_t cut = 0; cut < good.size(); cut += 7) {
    std::ofstream(name_, std::ios::binary) << good.substr(0, cut);
    EXPECT_THROW(readFeatureFile(name_), base::Error) << "cut at " << cut;
  }
  for (std::size_t at = 0; at < good.size(); at += 11) {
    std::string bad = good;
    bad[at] = static_cast<char>(bad[at] ^ 0x10);
    std::ofstream(name_, std::ios::binary) << bad;
    EXPECT_THROW(readFeatureFile(name_), base::Error) << "flipped at " << at;
  }
  std::ofstream(name_, std::ios::binary) << good << "x";
  EXPECT_THROW(readFeatureFile(name_), base::Error);
}

TEST_F(FeatureFileTest, MemoryTakesItsFeaturesAndStates) {
  memory::PlaceMemory one = engram::testing::ringMap(3, 10).places().begin()->second.memory;
  memory::PlaceMemory two = engram::testing::ringMap(3, 40).places().begin()->second.memory;
  EXPECT_GT(storedBytes(two), 2 * storedBytes(one));
  EXPECT_GE(storedBytes(two), 40u * 64u / 2);  // descriptors are compressed, but not that much
}

}  // namespace
}  // namespace engram::store
