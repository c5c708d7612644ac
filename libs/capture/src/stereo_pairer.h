// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>
#include <utility>

namespace engram::capture {

/// Joins the images of two cameras to pairs by their stamps. Images whose partner does not come are dropped
/// and counted.
template <class T>
class StereoPairer {
 public:
  struct Pair {
    double stamp;  ///< of the left image [s]
    T left, right;
  };

  /// @param tolerance greatest difference of the stamps of a pair [s]
  explicit StereoPairer(double tolerance) : tolerance_(tolerance) {}

  /// Stamps of one side must rise. @param side 0: left, 1: right
  std::optional<Pair> push(int side, double stamp, T image) {
    auto& own = waiting_[static_cast<std::size_t>(side)];
    auto& others = waiting_[static_cast<std::size_t>(1 - side)];
    // Whatever is too old for this image is too old for all that follow it.
    while (!others.empty() && others.front().first < stamp - tolerance_) drop(others);
    if (!others.empty() && std::abs(others.front().first - stamp) <= tolerance_) {
      unpaired_ += own.size();  // they waited for a partner that must have come before this one's
      own.clear();
      Item partner = std::move(others.front());
      others.pop_front();
      if (side == 0) return Pair{stamp, std::move(image), std::move(partner.second)};
      return Pair{partner.first, std::move(partner.second), std::move(image)};
    }
    own.emplace_back(stamp, std::move(image));
    if (own.size() > kMaxWaiting) drop(own);
    return std::nullopt;
  }

  std::size_t unpaired() const { return unpaired_; }

 private:
  using Item = std::pair<double, T>;
  static constexpr std::size_t kMaxWaiting = 8;

  void drop(std::deque<Item>& items) {
    items.pop_front();
    ++unpaired_;
  }

  double tolerance_;
  std::array<std::deque<Item>, 2> waiting_;
  std::size_t unpaired_ = 0;
};

}  // namespace engram::capture
