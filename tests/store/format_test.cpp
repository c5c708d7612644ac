// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Maps of released formats open for ever: tests/fixtures/map_v*/README.md says where they come from.
#include "engram/store/map_file.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <zlib.h>

namespace engram::store {
namespace {

using ::testing::IsEmpty;

/// A dump without its first line, which names the format of the program and not of the map.
std::string withoutFormat(const std::string& dump) { return dump.substr(dump.find('\n') + 1); }

std::string unpacked(const std::string& path) {
  std::string out;
  const gzFile in = gzopen(path.c_str(), "rb");
  if (in == nullptr) return out;
  char buffer[65536];
  for (int n = 0; (n = gzread(in, buffer, sizeof buffer)) > 0;) out.append(buffer, static_cast<size_t>(n));
  gzclose(in);
  return out;
}

class FormatTest : public StoreTest, public ::testing::WithParamInterface<const char*> {};

TEST_P(FormatTest, MapsOfOldVersionsOpenForEver) {
  const std::string fixture = std::string(ENGRAM_SOURCE_DIR "/tests/fixtures/") + GetParam();
  std::filesystem::copy_file(fixture + ".engram", path("a.engram"));
  const std::string expected = unpacked(fixture + ".dump.gz");
  ASSERT_GT(expected.size(), 1000u);
  const MapFile file = MapFile::open(path("a.engram"), Access::kReadOnly);
  EXPECT_THAT(file.check(), IsEmpty());
  EXPECT_GT(file.load().places().size(), 0u);
  std::ostringstream dump;
  file.dump(dump);
  EXPECT_EQ(withoutFormat(dump.str()), withoutFormat(expected));
}

/// Reading changes no byte; what is written is of the newest version, and the old content is still in it.
TEST_P(FormatTest, MapsOfOldVersionsAreReadUnchangedAndWrittenAsTheNewest) {
  const std::string name = path("a.engram");
  std::filesystem::copy_file(std::string(ENGRAM_SOURCE_DIR "/tests/fixtures/") + GetParam() + ".engram",
                             name);
  const std::string before = fileBytes(name);
  ASSERT_EQ(before[63], GetParam()[5] - '0') << "user_version";
  const auto content = [&] {
    const MapFile file = MapFile::open(name, Access::kReadOnly);
    EXPECT_THAT(file.check(), IsEmpty());
    return text(file.header(), file.load().content(), file.records());
  };
  const std::string known = content();
  EXPECT_EQ(fileBytes(name), before);
  {
    MapFile file = MapFile::open(name, Access::kReadWrite);
    auto map = file.load();
    file.commit(map, map.takeChanges());
  }
  EXPECT_EQ(fileBytes(name)[63], kFormatVersion);
  EXPECT_EQ(content(), known);
  const auto drives = MapFile::open(name, Access::kReadOnly).drives();
  EXPECT_EQ(drives.size(), GetParam() == std::string("map_v1/views") ? 1u : 2u);
  std::uint64_t images = 0;
  for (const Drive& drive : drives) images += drive.images;
  EXPECT_EQ(images, MapFile::open(name, Access::kReadOnly).records().size());
}

INSTANTIATE_TEST_SUITE_P(Old, FormatTest,
                         ::testing::Values("map_v1/places", "map_v1/views", "map_v2/places"));

}  // namespace
}  // namespace engram::store
