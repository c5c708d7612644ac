// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/world/library.h"

#include "engram/base/error.h"
#include "engram/base/image_header.h"
#include "paint.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <filesystem>

namespace engram::world {
namespace {

namespace fs = std::filesystem;
constexpr int kPosters = 60, kPeople = 10, kLooks = 4, kFacades = 14, kShops = 10;
constexpr std::size_t kMostPhotographs = 200;

/// Empty for what is no image, or too large for one.
cv::Mat readPhotograph(const std::string& path) {
  try {
    return cv::imdecode(base::readImageBytes(path), cv::IMREAD_COLOR);
  } catch (const base::Error&) {
    return {};
  }
}

std::vector<cv::Mat> readPhotographs(const std::string& folder) {
  std::error_code error;
  std::vector<fs::path> paths;
  for (fs::directory_iterator i(folder, error), end; !error && i != end; i.increment(error))
    paths.push_back(i->path());
  if (error) throw base::Error(folder + ": cannot be listed (" + error.message() + ")");
  std::sort(paths.begin(), paths.end());
  std::vector<cv::Mat> images;
  for (const auto& p : paths) {
    if (images.size() == kMostPhotographs) break;
    const cv::Mat image = readPhotograph(p.string());
    if (image.empty()) continue;
    cv::Mat small;  // a poster is seen from a metre or more: 256 px are enough
    cv::resize(image, small, {256, 256}, 0, 0, cv::INTER_AREA);
    images.push_back(small);
  }
  if (images.empty())
    throw base::Error(folder + ": holds no image that can be read; give a folder of photographs");
  return images;
}

}  // namespace

Library::Library(const Building& building, const std::string& photographs) {
  using namespace paint;
  const Rng seed = Rng(building.seed()).fork(5);
  std::uint64_t stream = 0;
  const auto fresh = [&] { return seed.fork(++stream); };
  Rng colours = fresh();
  const auto pale = [&] { return mix(randomPaint(colours, 120, 235), {215, 222, 225}, 0.5); };
  const auto deep = [&] { return randomPaint(colours, 45, 150); };

  const std::vector<int> walls{atlas.add(brick(fresh())),
                               atlas.add(plaster(fresh(), pale())),
                               atlas.add(panelling(fresh())),
                               atlas.add(plaster(fresh(), pale())),
                               atlas.add(wallTiles(fresh(), pale())),
                               atlas.add(plaster(fresh(), pale()))};
  const std::vector<int> floors{atlas.add(linoleum(fresh(), deep())), atlas.add(carpet(fresh(), deep())),
                                atlas.add(parquet(fresh())), atlas.add(floorTiles(fresh())),
                                atlas.add(carpet(fresh(), deep()))};
  for (int i = 0; i < 12; ++i) {  // 0 … 3 are for corridors
    Style s;
    s.wall = walls[static_cast<std::size_t>(i < 4 ? i % 3 : static_cast<int>(colours.below(6)))];
    s.floor = floors[static_cast<std::size_t>(i < 4 ? (i % 2 ? 3 : 0) : static_cast<int>(colours.below(5)))];
    s.wallScale = s.wall == walls[4] ? 0.67f : 0.5f;
    styles.push_back(s);
  }
  for (int i = 0; i < kLooks; ++i) {
    doors.push_back(atlas.add(door(fresh(), i)));
    shelves.push_back(atlas.add(bookshelf(fresh())));
    cabinets.push_back(atlas.add(cabinet(fresh())));
    cartons.push_back(atlas.add(cardboard(fresh())));
    woods.push_back(atlas.add(wood(fresh(), mix({70, 110, 150}, {190, 205, 215}, colours.uniform()))));
    fabrics.push_back(atlas.add(fabric(fresh(), randomPaint(colours, 30, 190))));
    rugs.push_back(atlas.add(rug(fresh())));
    boards.push_back(atlas.add(noticeBoard(fresh())));
    outside.push_back(atlas.add(paint::outside(seed.fork(7000), i)));
  }
  for (int i = 0; i < 6; ++i) smallThings.push_back(atlas.add(smallThing(fresh(), i)));
  for (std::size_t i = 0; i < building.doors().size(); ++i)
    signs.push_back(atlas.add(doorSign(fresh(), 101 + static_cast<int>(i))));
  for (int i = 0; i < kPeople; ++i) people.push_back(atlas.add(person(fresh())));
  if (photographs.empty())
    for (int i = 0; i < kPosters; ++i)
      posters.push_back(atlas.add(poster(seed.fork(8000 + static_cast<std::uint64_t>(i)))));
  else
    for (const auto& image : readPhotographs(photographs)) posters.push_back(atlas.add(image));
  ceiling = atlas.add(paint::ceiling(fresh()));
  radiator = atlas.add(paint::radiator(fresh()));
  lamp = atlas.add(paint::lamp(fresh()));
  screen = atlas.add(paint::screen(fresh()));
  foliage = atlas.add(paint::foliage(fresh()));
  grime = atlas.add(paint::grime(fresh()));
  white = atlas.add(plaster(fresh(), {215, 220, 222}));
  metal = atlas.add(cv::Mat(64, 64, CV_8UC3, cv::Scalar(105, 108, 110)));
  if (!building.plan().open) return;
  for (int i = 0; i < kFacades; ++i)
    facades.push_back(atlas.add(facade(fresh(), mix(randomPaint(colours, 60, 230), {185, 200, 210}, 0.5))));
  for (int i = 0; i < kLooks; ++i) streets.push_back(atlas.add(street(fresh(), i)));
  for (int i = 0; i < kShops; ++i) shops.push_back(atlas.add(shopFront(fresh())));
  for (int i = 0; i < kShops; ++i) signs.push_back(atlas.add(doorSign(fresh(), 1 + 2 * i)));
}

}  // namespace engram::world
