// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/map/topological_map.h"
#include "engram/pipeline/pipeline.h"
#include "engram/pipeline/whole_image.h"
#include "tiny_drive.h"
#include "tiny_map.h"

#include <gmock/gmock.h>
#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace engram::pipeline {
namespace {

using engram::testing::firstDrive;
using engram::testing::firstMap;
using engram::testing::secondDrive;
using engram::testing::tinyParams;
using types::Outcome;

/// The first map with a second building like it, a hundred metres away, that nothing joins to it.
map::TopologicalMap twice() {
  map::MapContent content = firstMap().content();
  const std::uint32_t places = content.nextPlace, edges = content.nextEdge;
  for (auto [id, place] : firstMap().places()) {
    place.id = base::PlaceId(id.value + places);
    place.T_map_place.pretranslate(Eigen::Vector3d(100, 0, 0));
    content.places.emplace(place.id, place);
  }
  for (auto [id, edge] : firstMap().edges()) {
    edge.id = base::EdgeId(id.value + edges);
    edge.a = base::PlaceId(edge.a.value + places);
    edge.b = base::PlaceId(edge.b.value + places);
    content.edges.emplace(edge.id, edge);
  }
  content.nextPlace += places;
  content.nextEdge += edges;
  return map::TopologicalMap(std::move(content));
}

int acceptedOneByOne(const PipelineParams& params, map::TopologicalMap map, const std::string& reason = {}) {
  Pipeline localizer(params, std::move(map), Use::kFrozen);
  int accepted = 0, named = 0;
  for (const auto& frame : firstDrive().frames) {
    localizer.restart();
    const types::FrameReport report = localizer.process(frame);
    accepted += report.outcome == Outcome::kRecognised;
    named += !reason.empty() && report.reason.find(reason) != std::string::npos;
  }
  return reason.empty() ? accepted : named;
}

// The first image after waking up, in a building that has a twin: no number of inliers can tell.
TEST(Ambiguity, ALeapToOneOfTwoPlacesThatLookAlikeIsRefusedAndSaid) {
  const int images = static_cast<int>(firstDrive().frames.size());
  EXPECT_GE(acceptedOneByOne(tinyParams(), firstMap()), images * 8 / 10);
  EXPECT_EQ(acceptedOneByOne(tinyParams(), twice()), 0);
  EXPECT_GE(acceptedOneByOne(tinyParams(), twice(), "ambiguous: places "), images * 8 / 10);
  PipelineParams careless = tinyParams();
  careless.recognise.ambiguity = 0;
  EXPECT_GT(acceptedOneByOne(careless, twice()), images / 2);
}

TEST(Acceptance, MatchesThatAreNoAccidentSufficeHoweverFew) {
  const auto accepted = [](double log10Nfa) {
    PipelineParams params = tinyParams();
    params.recognise.accept_inliers = params.recognise.sure_inliers = 550;  // of 600 features
    params.recognise.accept_log10_nfa = log10Nfa;
    Pipeline localizer(params, firstMap(), Use::kFrozen);
    int sum = 0;
    for (const auto& frame : secondDrive().frames)
      sum += localizer.process(frame).outcome == Outcome::kRecognised;
    return sum;
  };
  EXPECT_EQ(accepted(-1e3), 0);
  EXPECT_GE(accepted(-5), static_cast<int>(secondDrive().frames.size()) * 7 / 10);
}

TEST(WholeImage, FindsThePlaceWhereAnImageWasTakenWhateverTheHeading) {
  for (const char* name : {"thumbnail", "hog"}) {
    PipelineParams params = tinyParams();
    params.appearance.channel = name;
    const Perception perception(params.camera, params.extractor);
    WholeImage whole(appearance::makeDescriber(params.appearance, perception.panorama()));
    std::size_t index = 0;
    for (const auto& [id, place] : firstMap().places()) whole.add(firstMap(), id, index++);
    index = 0;
    for (const auto& [id, place] : firstMap().places()) {
      cv::Mat turned;
      const cv::Mat& image = firstDrive().frames[static_cast<std::size_t>(place.createdIndex)].image;
      const cv::Point2f centre(0.5F * static_cast<float>(image.cols - 1),
                               0.5F * static_cast<float>(image.rows - 1));
      cv::warpAffine(image, turned, cv::getRotationMatrix2D(centre, 70, 1), image.size());
      const auto s = whole.similarities(turned);
      ASSERT_EQ(s.size(), firstMap().places().size());
      EXPECT_EQ(std::max_element(s.begin(), s.end()) - s.begin(), static_cast<std::ptrdiff_t>(index)) << name;
      ++index;
    }
  }
}

TEST(WholeImage, APlaceWithoutAPictureIsLikeNothing) {
  PipelineParams params = tinyParams();
  params.appearance.channel = "hog";
  map::MapContent content = firstMap().content();
  const auto first = content.places.begin()->first;
  for (auto& [id, view] : content.views)
    if (view.place == first) view.jpeg = {0xff, 0xd8, 0x00};
  const map::TopologicalMap map(std::move(content));
  WholeImage whole(appearance::makeDescriber(params.appearance));
  whole.add(map, first, 0);
  EXPECT_EQ(whole.similarities(firstDrive().frames[0].image), std::vector<double>{0.5});
}

// Half the light, other furniture: what the features say, both channels say as well.
TEST(WholeImage, LocalisesWithTheFeatures) {
  PipelineParams params = tinyParams();
  params.appearance.channel = "hog";
  const auto accepted = [&](const PipelineParams& p) {
    Pipeline localizer(p, firstMap(), Use::kFrozen);
    int sum = 0;
    for (const auto& frame : secondDrive().frames)
      sum += localizer.process(frame).outcome == Outcome::kRecognised;
    return sum;
  };
  EXPECT_GE(accepted(params), static_cast<int>(secondDrive().frames.size()) * 9 / 10);
}

}  // namespace
}  // namespace engram::pipeline
