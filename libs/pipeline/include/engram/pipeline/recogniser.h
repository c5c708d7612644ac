// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/belief/bayes_filter.h"
#include "engram/belief/channel.h"
#include "engram/belief/sequence.h"
#include "engram/map/topological_map.h"
#include "engram/pipeline/dead_reckoning.h"
#include "engram/pipeline/params.h"
#include "engram/pipeline/place_match.h"
#include "engram/pipeline/scorer.h"
#include "engram/pipeline/whole_image.h"
#include "engram/types/frame_report.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

namespace engram::pipeline {

/// Recognise: features become a score for each place and a belief over all of them (F-19, F-20). It reads the
/// changes of the map itself: places that came or learnt, edges, poses. Places that leave a map are not for
/// it: they keep their number.
class Recogniser {
 public:
  enum class Mode {
    kMapping,       ///< "none of these" is a state of the filter (A-14)
    kLocalisation,  ///< the robot is somewhere in the map
  };

  /// @param stereo the camera, when views are held against places by their 3D points
  /// @param describer of whole images; null: features alone are evidence
  Recogniser(const PipelineParams& params, Mode mode, std::optional<StereoCamera> stereo = {},
             std::unique_ptr<appearance::Describer> describer = {});

  /// Takes over a whole map; the belief becomes uniform.
  void load(const map::TopologicalMap& map);
  /// Takes over what has changed in a map since. recognise() does it too.
  void follow(const map::TopologicalMap& map);

  /// Predicts by the motion model and weighs by this view. Hypotheses come by their posterior, at most
  /// `candidates` or `reported`, whichever is more.
  /// @param map the one that was loaded. @param excluded places that cannot be the answer:
  /// those just made.
  /// @param travel the motion since the last call; none when unknown. @param picture the whole image, for the
  /// channel that looks at it
  std::vector<types::Hypothesis> recognise(const map::TopologicalMap& map, const types::Features& view,
                                           const std::optional<Travel>& travel,
                                           const std::set<base::PlaceId>& excluded = {},
                                           const cv::Mat& picture = {});

  /// recognise() in its two halves. The score of each place in the order of its id, by descriptors alone.
  std::vector<double> similarities(const types::Features& view) const;
  /// @param scores one in [0, 1] for each place, in the order of its id; from similarities() or any other
  /// rule. @param whole the same by whole images; empty: features alone are evidence
  std::vector<types::Hypothesis> weigh(const std::vector<double>& scores, const std::optional<Travel>& travel,
                                       const std::set<base::PlaceId>& excluded = {},
                                       const std::vector<double>& whole = {});
  /// The last view held against a place; worked out once.
  const PlaceMatch& match(const map::TopologicalMap& map, const types::Features& view, base::PlaceId place);
  /// The same for a view of any time and any memory; not kept.
  PlaceMatch held(const types::Features& view, const memory::PlaceMemory& place) const;
  /// The places that the last view resembles most, whatever was believed before; fewer when it resembles no
  /// more.
  std::vector<types::Hypothesis> mostSimilar() const;
  /// The first so many of those that may be it.
  std::vector<types::Hypothesis> mostSimilar(std::size_t most,
                                             const std::function<bool(base::PlaceId)>& mayBe) const;
  /// Geometry alone has found the robot at this place: the belief follows.
  void confirm(base::PlaceId place);

  /// The belief becomes uniform again, and what images before have taught is forgotten.
  void restart();

  double newPlaceProbability() const { return filter_.posterior().newPlace; }
  /// Posterior mass of a place and the places within `accept_hops` edges.
  double neighbourhoodMass(base::PlaceId place) const;
  /// Where this image and those before it together put the robot, when the belief agrees and no other place
  /// comes near; none while mapping, and where `sequence` is 0.
  std::optional<base::PlaceId> bySequence() const;
  /// Maximum of the posterior with sub-place resolution along the chain of places (F-E14); -1 on an empty
  /// map.
  double interpolatedPeak() const;

 private:
  /// An edge that a robot may go along, between places by index.
  struct Passage {
    int a = -1, b = -1;
    bool counts = false;      ///< for the mean distance: an odometry edge
    std::int64_t length = 0;  ///< of that [nm]: whole numbers add up to the same in any order
  };

  void placeChanged(const map::TopologicalMap& map, const map::Place& place);
  void edgeChanged(const map::Edge& edge, std::set<int>& touched);
  void edgeRemoved(base::EdgeId id, std::set<int>& touched);
  void placeMoved(const map::Place& place);
  void count(const Passage& passage, int sign);
  void connect(const map::TopologicalMap& map, int index);
  int indexOf(base::PlaceId id) const;
  void predict(const std::optional<Travel>& travel);
  std::vector<types::Hypothesis> weighPredicted(const std::vector<double>& scores, bool travelled,
                                                const std::set<base::PlaceId>& excluded,
                                                const std::vector<double>& whole);
  void update(const belief::Likelihood& features, const std::vector<double>& scores,
              const std::set<base::PlaceId>& excluded, const std::vector<double>& whole);
  void addToSequence(const std::vector<double>& features, const std::vector<double>& whole);
  types::Hypothesis hypothesis(std::size_t index) const;
  std::vector<std::size_t> likely() const;
  auto notOf(const std::set<base::PlaceId>& excluded) const {
    return [this, &excluded](std::size_t index) { return !excluded.contains(ids_[index]); };
  }
  std::vector<double> verifiedScores(const map::TopologicalMap& map, const types::Features& view,
                                     const std::vector<double>& scores,
                                     const std::set<base::PlaceId>& excluded);
  belief::Likelihood likelihoodWithout(const std::set<base::PlaceId>& excluded, std::vector<double> scores,
                                       const belief::Channel& channel,
                                       std::optional<double> newPlace = {}) const;

  RecogniseParams params_;
  Mode mode_;
  features::MatchParams matching_;
  geometry::VerifyParams verify_;
  geometry::StereoVerifyParams stereoVerify_;
  std::optional<StereoCamera> stereo_;
  std::unique_ptr<Scorer> scorer_;
  double usualSpacing_;                   // while no edge tells [m]
  double spacing_;                        // mean distance of neighbouring places [m]
  std::int64_t counted_ = 0, steps_ = 0;  // sum [nm] and number of the odometry edges
  belief::BayesFilter filter_;
  belief::Channel byFeatures_;
  std::optional<WholeImage> wholeImage_;  // none: features alone are evidence
  belief::Channel byWhole_;
  std::optional<belief::Sequence> sequence_;  // none: each image speaks for itself
  int reach_ = 0;                             // of the robot since the image before [edges]
  belief::Adjacency adjacency_;
  std::vector<double> lastScores_;               // of the last view; 0 for excluded places
  std::map<base::PlaceId, PlaceMatch> matches_;  // of the last view
  std::vector<base::PlaceId> ids_;               // ascending; index in the filter and in the scorer
  std::map<base::EdgeId, Passage> passages_;
  map::Cursor read_;
};

}  // namespace engram::pipeline
