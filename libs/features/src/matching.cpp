// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/features/matching.h"

#include "matching_detail.h"
#include "nearest.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

namespace engram::features {

void MatchParams::describe(base::Params& p) {
  p.add("ratio", ratio, "largest ratio of the nearest to the second nearest distance; 1 = no ratio test",
        {0.01, 1});
  p.add("mutual", mutual, "matches must be nearest in both directions");
  p.add("max_distance", max_distance,
        "largest distance: L2 of unit vectors, or share of differing bits; 0 = any", {0, 2});
}

namespace detail {
namespace {

using types::DescriptorKind;

/// A nearest neighbour by index of the original sets.
struct Neighbour {
  int a = -1, b = -1;
  float first = 0, second = 0;
};

float toDistance(float kernelValue, DescriptorKind kind, int dim) {
  switch (kind) {
    case DescriptorKind::kFloat:
      return std::sqrt(kernelValue);
    case DescriptorKind::kInt8:
      return std::sqrt(kernelValue) / types::kInt8Scale;
    case DescriptorKind::kBinary:
      return kernelValue / static_cast<float>(dim);
  }
  return kernelValue;
}

/// Kernel values of vectors are squares.
bool passesRatio(const Neighbour& n, double ratio, DescriptorKind kind) {
  if (ratio >= 1) return true;
  if (std::isinf(n.second)) return false;
  const double factor = kind == DescriptorKind::kBinary ? ratio : ratio * ratio;
  return static_cast<double>(n.first) < factor * static_cast<double>(n.second);
}

/// Index of the nearest feature of `set` and both distances, over one group or all groups.
class Searcher {
 public:
  Searcher(SimdLevel level, const PreparedSet& queries, const PreparedSet& set)
      : level_(level), queries_(queries), set_(set), split_(queries.isSigned && set.isSigned) {}

  /// Calls visit(Neighbour) for each query of group g that has a neighbour.
  template <class Visit>
  void each(std::size_t g, Visit&& visit) {
    const auto& queries = queries_.groups[g];
    search(g, 0, queries.count);
    for (int q = 0; q < queries.count; ++q) {
      const Neighbour n = neighbour(g, q, 0);
      if (n.b >= 0) visit(n);
    }
  }

  Neighbour one(std::size_t g, int row) {
    search(g, row, row + 1);
    return neighbour(g, row, row);
  }

 private:
  void search(std::size_t g, int begin, int end) {
    for (std::size_t h = 0; h < 2; ++h) {
      found_[h].resize(static_cast<std::size_t>(end - begin));
      if (split_ && h != g) continue;
      findNearest(level_, set_.kind, queries_.groups[g], begin, end, set_.groups[h], found_[h].data());
    }
  }

  Neighbour neighbour(std::size_t g, int row, int begin) const {
    Neighbour n{queries_.groups[g].index[static_cast<std::size_t>(row)], -1,
                std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity()};
    for (std::size_t h = 0; h < 2; ++h) {
      if (split_ && h != g) continue;
      const Nearest& found = found_[h][static_cast<std::size_t>(row - begin)];
      if (found.row < 0) continue;
      const int index = set_.groups[h].index[static_cast<std::size_t>(found.row)];
      if (std::tie(found.first, index) < std::tie(n.first, n.b) || n.b < 0) {
        n.second = std::min(n.first, found.second);
        n.first = found.first;
        n.b = index;
      } else {
        n.second = std::min(n.second, found.first);
      }
    }
    return n;
  }

  const SimdLevel level_;
  const PreparedSet &queries_, &set_;
  const bool split_;
  std::vector<Nearest> found_[2];
};

/// Where a feature of the original set is: its group and row.
struct Slot {
  std::size_t group = 0;
  int row = 0;
};

Slot slotOf(const PreparedSet& set, int index) {
  for (std::size_t g = 0; g < 2; ++g) {
    const auto& list = set.groups[g].index;
    const auto at = std::lower_bound(list.begin(), list.end(), index);
    if (at != list.end() && *at == index) return {g, static_cast<int>(at - list.begin())};
  }
  throw std::logic_error("slotOf: no such feature");
}

/// For each b the nearest of the a that chose it.
void makeOneToOne(std::vector<Neighbour>& chosen) {
  const auto key = [](const Neighbour& n) { return std::tie(n.b, n.first, n.a); };
  std::sort(chosen.begin(), chosen.end(), [&](const auto& x, const auto& y) { return key(x) < key(y); });
  const auto sameB = [](const auto& x, const auto& y) { return x.b == y.b; };
  chosen.erase(std::unique(chosen.begin(), chosen.end(), sameB), chosen.end());
}

}  // namespace

std::vector<types::Match> matchPrepared(SimdLevel level, const PreparedSet& a, const PreparedSet& b,
                                        const MatchParams& params) {
  if (a.size == 0 || b.size == 0) return {};
  if (a.kind != b.kind || a.dim != b.dim)
    throw std::invalid_argument("match: descriptors of another kind or dimension");
  std::vector<Neighbour> chosen;
  Searcher forward(level, a, b);
  for (std::size_t g = 0; g < 2; ++g)
    forward.each(g, [&](const Neighbour& n) {
      const bool near = params.max_distance <= 0 || toDistance(n.first, a.kind, a.dim) <= params.max_distance;
      if (near && passesRatio(n, params.ratio, a.kind)) chosen.push_back(n);
    });
  makeOneToOne(chosen);
  if (params.mutual) {
    // Few pass the ratio test, so the way back is searched for these only. A mutual match is nearest for its
    // b, so the one-to-one selection above did not lose it.
    Searcher backward(level, b, a);
    std::erase_if(chosen, [&](const Neighbour& n) {
      const Slot slot = slotOf(b, n.b);
      return backward.one(slot.group, slot.row).b != n.a;
    });
  }
  std::sort(chosen.begin(), chosen.end(), [](const auto& x, const auto& y) { return x.a < y.a; });
  std::vector<types::Match> matches;
  matches.reserve(chosen.size());
  for (const auto& n : chosen) matches.push_back({n.a, n.b, toDistance(n.first, a.kind, a.dim)});
  return matches;
}

types::Features quantisedFeatures(const types::Features& features) {
  return {features.keypoints, types::quantised(features.descriptors), {}};
}

}  // namespace detail

std::vector<types::Match> match(const types::Features& a, const types::Features& b,
                                const MatchParams& params) {
  using types::DescriptorKind;
  const auto prepared = [](const types::Features& f, const types::Features& other) {
    const bool mixed =
        f.descriptors.kind() == DescriptorKind::kFloat && other.descriptors.kind() == DescriptorKind::kInt8;
    return mixed ? PreparedSet(detail::quantisedFeatures(f)) : PreparedSet(f);
  };
  return detail::matchPrepared(supportedSimd(), prepared(a, b), prepared(b, a), params);
}

}  // namespace engram::features
