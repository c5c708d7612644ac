// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <utility>

namespace engram::capture {

/// What a full queue does with one more item.
enum class WhenFull {
  kDropOldest,  ///< for live work: what is new counts
  kBlock,       ///< for recording: everything counts, the writer of the queue waits
};

struct QueueCounters {
  std::size_t pushed = 0;   ///< items that came in
  std::size_t dropped = 0;  ///< of them, those that made room for newer ones
  std::size_t waits = 0;    ///< pushes that had to wait for room
  std::size_t longest = 0;  ///< most items that ever waited at once
};

/// A queue between two threads that never grows beyond `capacity`.
template <class T>
class BoundedQueue {
 public:
  BoundedQueue(std::size_t capacity, WhenFull whenFull)
      : capacity_(std::max<std::size_t>(1, capacity)), whenFull_(whenFull) {}

  /// False when the queue is closed; the item is then lost.
  bool push(T item) {
    std::unique_lock lock(mutex_);
    if (!closed_ && items_.size() >= capacity_) {
      if (whenFull_ == WhenFull::kBlock) {
        ++counters_.waits;
        room_.wait(lock, [this] { return closed_ || items_.size() < capacity_; });
      } else {
        items_.pop_front();
        ++counters_.dropped;
      }
    }
    if (closed_) return false;
    items_.push_back(std::move(item));
    ++counters_.pushed;
    counters_.longest = std::max(counters_.longest, items_.size());
    filled_.notify_one();
    return true;
  }

  /// The oldest item; none when `patience` ran out, or when the queue is closed and empty.
  std::optional<T> pop(std::chrono::duration<double> patience) {
    std::unique_lock lock(mutex_);
    filled_.wait_for(lock, patience, [this] { return closed_ || !items_.empty(); });
    if (items_.empty()) return std::nullopt;
    std::optional<T> item(std::move(items_.front()));
    items_.pop_front();
    room_.notify_one();
    return item;
  }

  /// No more items come in. What is in the queue can still be taken out.
  void close() {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    filled_.notify_all();
    room_.notify_all();
  }

  /// Closed, and everything was taken out.
  bool finished() const {
    const std::lock_guard lock(mutex_);
    return closed_ && items_.empty();
  }

  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return items_.size();
  }

  QueueCounters counters() const {
    const std::lock_guard lock(mutex_);
    return counters_;
  }

 private:
  const std::size_t capacity_;
  const WhenFull whenFull_;
  mutable std::mutex mutex_;
  std::condition_variable filled_, room_;
  std::deque<T> items_;
  bool closed_ = false;
  QueueCounters counters_;
};

}  // namespace engram::capture
