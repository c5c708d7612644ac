// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"
#include "engram/memory/place_memory.h"
#include "engram/memory/redetections.h"

#include <string>

namespace engram::memory {

/// Section `[fsh]`.
struct FshParams {
  double vote = 1.0;           ///< nominal vote v of F eq (2) and (3)
  double ltm_threshold = 0.7;  ///< on the FSH divided by its maximum (F-15, F-E9)
  int prune_view = 4;          ///< updates that a feature is given before it can be pruned (F-15, F-E5)
  std::string vote_variance = "second_moment";  ///< sigma_m^2 of F eq (2) (F-E7)
  double fixed_sigma = 0.25;                    ///< sigma_m when vote_variance = fixed; a descriptor distance
  std::string new_vote = "max";                 ///< norm of the responses in F eq (3) (F-E8)
  int ltm_min_features = 280;           ///< floor of the long-term memory (F-E10; F-30 reports <= 284)
  int max_features = 764;               ///< cap on short- and long-term features together (F-30)
  std::string keep_descriptor = "old";  ///< of a re-observed feature (F-E22)
  int history_length = 32;              ///< kept values of rfsh (F-04)
  double duplicate_distance = 0.1;  ///< descriptor distance; no insertion next to a feature so near (F-E4)
  /// `fixed`: ltm_threshold and prune_view are the numbers above. `learned`: they are where learning starts;
  /// the map's own re-detections take over as they come in (F-31, D-12).
  std::string thresholds = "fixed";
  double forget_chance = 0.1;  ///< of learntForgettingAge(); a feature seen once in 50 views is worth nothing
  double decay = 1.0;          ///< factor on all votes before each update; 1 is the paper (F-31)

  void describe(base::Params& p);
};

/// The Feature Stability Histogram of Bacca, Salvi & Cufi 2011 (F-01 to F-04, F-12 to F-16).
///
/// An update rehearses the matched features, short-term or long-term alike (F-E3), with the vote of eq (2);
/// inserts the unmatched ones with the vote of eq (3) (F-E4); prunes by eq (4); divides the histogram by its
/// maximum (F-E9) and splits it into long-term and short-term memory.
///
/// Votes accumulate without bound, as in the paper. So 1/max of eq (4) tends to zero in a long life, and
/// pruning with it: the cap takes over. A feature that appears late needs as many votes as the oldest one to
/// count as much; with `decay` < 1 it needs about 1/(1 - decay) updates instead.
class Fsh : public MemoryModel {
 public:
  /// Throws base::ConfigError that names the key in [fsh].
  explicit Fsh(FshParams params);

  PlaceMemory start(const types::Features& view) const override;

  /// Throws std::invalid_argument when the matches are not one-to-one or not in range (F-E11), and when the
  /// layout of the descriptors, or whether there are bearings, differs between view and memory. The memory is
  /// unchanged then. Bearings of `view` must be expressed in the frame of the place.
  types::MemoryChange update(PlaceMemory& memory, const types::Features& view,
                             std::span<const types::Match> matches) const override;

  /// update() after counting the view in `seen`, and with the threshold and the forgetting age that `seen`
  /// then gives, if [fsh] thresholds = learned. `seen` is counted either way, so that a map can be asked to
  /// learn later. The floor ltm_min_features holds in both.
  types::MemoryChange learn(PlaceMemory& memory, const types::Features& view,
                            std::span<const types::Match> matches, Redetections& seen) const override;

  const FshParams& params() const { return params_; }

 private:
  FshParams params_;
};

/// The parameters by which learn() updates: ltm_threshold and prune_view as learnt, if they are to be.
FshParams paramsInForce(FshParams params, const Redetections& seen);

/// F eq (2): the vote of each re-observed feature, in the order of `matches`. See FshParams::vote_variance
/// (F-E7).
std::vector<double> rehearsalVotes(std::span<const types::Match> matches, const FshParams& params);

/// F eq (3): the vote of each feature of a view, were it new. See FshParams::new_vote (F-E8).
std::vector<double> insertionVotes(std::span<const types::Keypoint> keypoints, const FshParams& params);

}  // namespace engram::memory
