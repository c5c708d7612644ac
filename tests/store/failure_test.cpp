// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Each call to the disk and each allocation fails once, in turn, and the power at many moments. One law: the
// map is sound then, and is that of the undisturbed run after as many images as were reported as written, or
// after the one more that was under way.
#include "engram/memory/fsh.h"
#include "engram/store/map_file.h"
#include "faulty_vfs.h"
#include "power_cut.h"
#include "sample_map.h"
#include "store_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>

namespace engram::store {
namespace {

using test::Call;
using test::Fault;
using test::How;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kImages = 20, kDescriptorDim = 8;

/// What an image does to the map, as far as a store can tell: all kinds of rows come, change and go.
void learnImage(map::TopologicalMap& map, int image, base::Rng& rng) {
  const auto last = map.places().empty() ? map::PlaceId() : map.places().rbegin()->first;
  if (image % 3 == 0) {
    map::Place place;
    place.memory = engram::testing::randomMemory(rng, 6, 2, kDescriptorDim);
    const auto id = map.addPlace(place);
    map.addView({.place = id, .stamp = 1.0 * image, .label = "v"});
    if (last.valid())
      map.addEdge({.a = last, .b = id, .T_a_b = engram::testing::relPose(Eigen::Isometry3d::Identity())});
  } else {
    map.remember(last, memory::Fsh({}), engram::testing::randomFeatures(rng, 3, kDescriptorDim), {});
    map.setPose(last, engram::testing::planarPose(rng.normal(), rng.normal(), rng.normal()));
  }
  if (image % 7 == 6) map.removePlace(map.places().begin()->first, map.places().rbegin()->first);
  map.addPathPoint({.session = image / 8, .stamp = 1.0 * image, .anchor = map.places().rbegin()->first});
}

struct Session {
  int done = -1;  ///< images whose commit returned; -1 when the map was not even made
  bool closed = false;
  std::string complaint;  ///< the base::Error that ended it
};

/// Maps the images, opens the map again in the middle as an extending program does, and ends at the first
/// error. Calls `committed` after each commit.
Session mapImages(const std::string& path, const std::function<void(MapFile&)>& committed = {}) {
  Session run;
  try {
    base::Rng rng(3);
    map::TopologicalMap map;
    map::MapHeader header = sampleHeader();
    header.descriptorDim = kDescriptorDim;
    MapFile file = MapFile::create(path, header);
    for (run.done = 0; run.done < kImages;) {
      if (committed) committed(file);
      if (run.done == kImages / 2) {
        file.close();
        file = MapFile::open(path, Access::kReadWrite);
        map = file.load();
      }
      types::FrameReport report = sampleReport();
      report.index = static_cast<std::uint64_t>(run.done);
      learnImage(map, run.done, rng);
      file.commit(map, map.takeChanges(), &report);
      ++run.done;
    }
    if (committed) committed(file);
    file.close();
    run.closed = true;
  } catch (const base::Error& e) {
    run.complaint = e.what();
  }
  return run;
}

class FailureTest : public StoreTest {
 protected:
  void SetUp() override {
    StoreTest::SetUp();
    if (!whole_.empty()) return;
    const test::FaultyVfs vfs;  // that waits for no disk
    const Session run =
        mapImages(path("whole.engram"), [&](MapFile& file) { whole_.push_back(dumpOf(file)); });
    ASSERT_TRUE(run.closed) << run.complaint;
    ASSERT_EQ(whole_.size(), kImages + 1u);
    for (int i = 1; i <= kImages; ++i) ASSERT_NE(at(i), at(i - 1));
  }

  static std::string dumpOf(const MapFile& file) {
    std::ostringstream out;
    file.dump(out);
    return out.str();
  }
  const std::string& at(int images) const { return whole_[static_cast<std::size_t>(images)]; }

  /// The law at the head of this file, for a reader and then for the next writer.
  void expectPrefix(const std::string& name, int done, bool closed) const {
    if (done < 0) return expectNothingOrEmpty(name);
    for (const Access access : {Access::kReadOnly, Access::kReadWrite}) {
      std::optional<test::FaultyVfs> hasty;  // the writer need not wait for the disk
      if (access == Access::kReadWrite) hasty.emplace();
      MapFile file = MapFile::open(name, access);
      EXPECT_THAT(file.check(), IsEmpty());
      const std::string found = dumpOf(file);
      if (closed || done == kImages)
        EXPECT_EQ(found, at(kImages));
      else
        EXPECT_THAT(found, AnyOf(at(done), at(done + 1)));
      EXPECT_NO_THROW(file.close());
    }
    std::error_code none;  // an empty log that could not be deleted holds nothing
    const auto logged = std::filesystem::file_size(name + "-wal", none);
    EXPECT_TRUE(none || logged == 0) << logged;
  }

  /// The map was never reported as made: there is none, or one without images, and it can be made anew.
  void expectNothingOrEmpty(const std::string& name) const {
    std::string found = at(0);
    const std::string message = messageOf([&] { found = dumpOf(MapFile::open(name, Access::kReadOnly)); });
    EXPECT_EQ(found, at(0)) << message;
    EXPECT_NO_THROW(MapFile::create(name, sampleHeader(), true)) << message;
  }

  void forget(const std::string& name) const {
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) std::filesystem::remove(name + suffix);
  }

  /// Fails at each n until a run gets through; how many failures that were.
  int failEach(Fault fault) {
    int fired = 0;
    for (fault.at = 1;; ++fault.at) {
      const std::string name = path("m.engram");
      Session run;
      {
        test::FaultyVfs vfs;
        vfs.arm(fault);
        run = mapImages(name);
        EXPECT_TRUE(vfs.fired() || run.closed) << run.complaint;
        if (!vfs.fired()) return fired;
      }
      ++fired;
      SCOPED_TRACE(std::string(toString(fault.call)) + ' ' + std::to_string(fault.at) + ": " + run.complaint);
      EXPECT_TRUE(run.closed || run.complaint.find(name) != std::string::npos);
      EXPECT_THAT(run.complaint, Not(HasSubstr("damaged")));
      expectPrefix(name, run.done, run.closed);
      if (HasFailure()) return fired;
      forget(name);
    }
  }

  inline static std::vector<std::string> whole_;  // the undisturbed run's dump after each image
};

struct FaultCase {
  const char* name;
  Fault fault;
  int atLeast;  ///< so many failures, or the run does not do what it is for
};

class EachCallFails : public FailureTest, public ::testing::WithParamInterface<FaultCase> {};

TEST_P(EachCallFails, AndThePrefixIsThere) {
  const int fired = failEach(GetParam().fault);
  RecordProperty("failures", fired);
  EXPECT_GE(fired, GetParam().atLeast);
}

INSTANTIATE_TEST_SUITE_P(
    Calls, EachCallFails,
    ::testing::Values(FaultCase{"OpenOnce", {.call = Call::kOpen}, 4},
                      FaultCase{"OpenForGood", {.call = Call::kOpen, .forGood = true}, 4},
                      FaultCase{"ReadOnce", {.call = Call::kRead}, 10},
                      FaultCase{"ReadForGood", {.call = Call::kRead, .forGood = true}, 10},
                      FaultCase{"WriteOnce", {.call = Call::kWrite}, 200},
                      FaultCase{"WriteForGood", {.call = Call::kWrite, .forGood = true}, 200},
                      FaultCase{"ShortWriteOnce", {.call = Call::kWrite, .how = How::kShort}, 200},
                      FaultCase{"DiskFull", {.call = Call::kWrite, .forGood = true, .how = How::kFull}, 200},
                      FaultCase{"TruncateOnce", {.call = Call::kTruncate}, 1},
                      FaultCase{"TruncateForGood", {.call = Call::kTruncate, .forGood = true}, 1},
                      FaultCase{"SyncOnce", {.call = Call::kSync}, 20},
                      FaultCase{"SyncForGood", {.call = Call::kSync, .forGood = true}, 20},
                      FaultCase{"DeleteOnce", {.call = Call::kDelete}, 2},
                      FaultCase{"DeleteForGood", {.call = Call::kDelete, .forGood = true}, 2},
                      FaultCase{"ShmOnce", {.call = Call::kShm}, 2},
                      FaultCase{"ShmForGood", {.call = Call::kShm, .forGood = true}, 2}),
    [](const auto& one) { return one.param.name; });

/// What was reported as written survives the loss of power: synchronous = FULL.
TEST_F(FailureTest, PowerCutsLoseNothingReported) {
  const std::string name = path("m.engram");
  std::vector<std::size_t> returned;  // events of the disk when the map was made, and after each image
  std::vector<test::DiskEvent> events;
  {
    test::FaultyVfs vfs;
    vfs.keepLog();
    ASSERT_TRUE(mapImages(name, [&](MapFile&) { returned.push_back(vfs.log().size()); }).closed);
    events = vfs.log();
  }
  base::Rng rng(29);
  int cuts = 0, changed = 0;
  for (; cuts < 200; ++cuts) {
    const std::size_t moment = rng.below(static_cast<std::uint32_t>(events.size()) + 1);
    forget(name);
    const test::Files disk = afterPowerCut(std::span(events).first(moment), rng);
    for (const auto& [file, bytes] : disk) writeBytes(file, bytes);
    const auto done = std::upper_bound(returned.begin(), returned.end(), moment) - returned.begin() - 1;
    SCOPED_TRACE("cut " + std::to_string(cuts) + " after event " + std::to_string(moment));
    expectPrefix(name, static_cast<int>(done), false);
    changed += moment > 0 && events[moment - 1].kind != test::DiskEvent::Kind::kSync;
    if (HasFailure()) break;
  }
  RecordProperty("cuts", cuts);
  RecordProperty("with_unsynced_changes", changed);
  EXPECT_EQ(cuts, 200);
  EXPECT_GT(changed, 100);
}

/// Does the harness see a store that does not wait for the disk? A commit that is not synced must be lost
/// sometimes, or the test above proves nothing.
TEST_F(FailureTest, PowerCutsLoseWhatWasNotSynced) {
  const std::string name = path("m.engram");
  std::vector<test::DiskEvent> events;
  {
    test::FaultyVfs vfs;
    vfs.keepLog();
    mapImages(name, [&](MapFile&) { events = vfs.log(); });
  }
  std::erase_if(events, [](const auto& e) { return e.kind == test::DiskEvent::Kind::kSync; });
  base::Rng rng(31);
  int lost = 0;
  for (int cut = 0; cut < 20; ++cut) {
    forget(name);
    for (const auto& [file, bytes] : test::afterPowerCut(events, rng)) writeBytes(file, bytes);
    std::string found;
    messageOf([&] { found = dumpOf(MapFile::open(name, Access::kReadOnly)); });
    lost += found != at(kImages);
  }
  EXPECT_GT(lost, 10);
}

class MemoryFails : public FailureTest, public ::testing::WithParamInterface<bool> {};

TEST_P(MemoryFails, AndThePrefixIsThere) {
  const std::string name = path("m.engram");
  test::FaultyMemory memory;
  int fired = 0, misnamed = 0;
  // Each of the first, then ever fewer; ENGRAM_ALLOCATIONS=all for each of some thousands.
  const char* wish = std::getenv("ENGRAM_ALLOCATIONS");
  const std::uint64_t thin = wish != nullptr && std::string(wish) == "all" ? UINT64_MAX : 40;
  for (std::uint64_t n = 1;; n += 1 + n / thin) {
    Session run;
    {
      const test::FaultyVfs vfs;  // that waits for no disk
      memory.arm(n, GetParam());
      run = mapImages(name);
    }
    const bool failed = memory.fired();
    memory.arm(0, false);
    if (!failed) break;
    ++fired;
    misnamed += run.complaint.find("damaged") != std::string::npos;
    SCOPED_TRACE("allocation " + std::to_string(n) + ": " + run.complaint);
    EXPECT_TRUE(run.closed || run.complaint.find(name) != std::string::npos);
    expectPrefix(name, run.done, run.closed);
    if (HasFailure()) break;
    forget(name);
  }
  RecordProperty("failures", fired);
  RecordProperty("called_damage", misnamed);
  EXPECT_GT(fired, 100);
}

INSTANTIATE_TEST_SUITE_P(Memory, MemoryFails, ::testing::Bool(),
                         [](const auto& one) { return one.param ? "ForGood" : "Once"; });

}  // namespace
}  // namespace engram::store
