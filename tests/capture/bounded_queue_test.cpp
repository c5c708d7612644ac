// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/capture/bounded_queue.h"

#include <gtest/gtest.h>

#include <memory>
#include <numeric>
#include <thread>
#include <vector>

namespace engram::capture {
namespace {

using namespace std::chrono_literals;

template <class T>
std::vector<T> drain(BoundedQueue<T>& queue) {
  std::vector<T> items;
  while (auto item = queue.pop(0s)) items.push_back(std::move(*item));
  return items;
}

TEST(BoundedQueue, DropsTheOldestAndCountsIt) {
  BoundedQueue<int> queue(3, WhenFull::kDropOldest);
  for (int i = 0; i < 8; ++i) EXPECT_TRUE(queue.push(i));
  EXPECT_EQ(queue.size(), 3u);
  EXPECT_EQ(drain(queue), (std::vector<int>{5, 6, 7}));
  const QueueCounters counters = queue.counters();
  EXPECT_EQ(counters.pushed, 8u);
  EXPECT_EQ(counters.dropped, 5u);
  EXPECT_EQ(counters.waits, 0u);
  EXPECT_EQ(counters.longest, 3u);
}

TEST(BoundedQueue, BlocksAndLosesNothing) {
  BoundedQueue<int> queue(4, WhenFull::kBlock);
  constexpr int kItems = 5000;
  std::thread producer([&] {
    for (int i = 0; i < kItems; ++i) queue.push(i);
    queue.close();
  });
  std::vector<int> taken;
  while (!queue.finished())
    if (auto item = queue.pop(1s)) taken.push_back(*item);
  producer.join();
  std::vector<int> all(kItems);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(taken, all);
  EXPECT_EQ(queue.counters().dropped, 0u);
  EXPECT_LE(queue.counters().longest, 4u);
}

TEST(BoundedQueue, BothPoliciesAccountForEveryItem) {
  for (const WhenFull policy : {WhenFull::kDropOldest, WhenFull::kBlock}) {
    BoundedQueue<int> queue(2, policy);
    std::size_t taken = 0;
    std::thread consumer([&] {
      while (!queue.finished()) taken += queue.pop(1s).has_value();
    });
    for (int i = 0; i < 2000; ++i) queue.push(i);
    queue.close();
    consumer.join();
    EXPECT_EQ(taken + queue.counters().dropped, 2000u);
  }
}

TEST(BoundedQueue, CloseWakesAWaitingProducerAndConsumer) {
  BoundedQueue<int> full(1, WhenFull::kBlock);
  full.push(1);
  bool accepted = true;
  std::thread producer([&] { accepted = full.push(2); });
  while (full.counters().waits == 0) std::this_thread::yield();
  full.close();
  producer.join();
  EXPECT_FALSE(accepted);
  EXPECT_FALSE(full.finished());  // the first item is still there
  EXPECT_EQ(drain(full), std::vector<int>{1});
  EXPECT_TRUE(full.finished());
  EXPECT_FALSE(full.push(3));

  BoundedQueue<int> empty(1, WhenFull::kBlock);
  std::thread consumer([&] { EXPECT_FALSE(empty.pop(std::chrono::hours(1))); });
  empty.close();
  consumer.join();
}

TEST(BoundedQueue, TakesThingsThatCannotBeCopied) {
  BoundedQueue<std::unique_ptr<int>> queue(1, WhenFull::kDropOldest);
  queue.push(std::make_unique<int>(1));
  queue.push(std::make_unique<int>(2));
  EXPECT_EQ(**queue.pop(0s), 2);
}

}  // namespace
}  // namespace engram::capture
