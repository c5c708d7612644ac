// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

namespace engram::apps {

/// What became of one image of the second pass, held against the truth.
struct PassAnswer {
  bool accepted = false;        ///< by the belief and by geometry
  bool right = false;           ///< the accepted place is right; without meaning otherwise
  bool bestGuessRight = false;  ///< the most probable place is right
  bool verified = false;        ///< some place was probable enough for geometry to be asked
};

/// Why an image was not tracked, and how else an attempt ends.
enum class Miss : std::uint8_t {
  kGeometry,     ///< the filter was right, and geometry refused it
  kUnsure,       ///< the filter was right, but no place was probable enough
  kWrongGuess,   ///< the most probable place was wrong; nothing was accepted
  kWrongAccept,  ///< a wrong place was accepted
  kEndOfDrive,   ///< there are no more images
};
inline constexpr std::size_t kMisses = 5;
const char* toString(Miss miss);
Miss missOf(const PassAnswer& answer);

/// One attempt at global localisation.
struct Attempt {
  std::size_t start = 0;         ///< first image
  int trials = 0;                ///< images fed until one was accepted, that one included
  bool located = false;          ///< one was accepted, and its place is right
  int trackings = 0;             ///< images in a row after it that were accepted and right
  Miss end = Miss::kEndOfDrive;  ///< why it ended
  int accepted = 0,
      wrong = 0;  ///< images accepted; of these at a wrong place: 0 or 1, as it ends the attempt
  std::array<int, kMisses> misses{};  ///< images not accepted, by reason; the last two are always 0
};

/// The answer to image `i`; `restart`: every place is equally likely before it.
using AskImage = std::function<PassAnswer(std::size_t i, bool restart)>;

/// Trials and trackings of A-21, from one first image. Our reading of the paper: the prior is uniform, images
/// follow in their order until one is accepted; that many images were needed, so a place found at once takes
/// one trial. From there on an image is tracked when it is accepted by itself, belief over the threshold and
/// geometry satisfied, at a right place. The first one that is not ends the attempt: the paper says that
/// tracking is lost when geometry refuses, though the filter goes on to be right. The image that was accepted
/// first is a trial, no tracking. A wrong acceptance ends an attempt too: the robot believes itself located.
/// So does the end of the drive; an attempt that has found nothing by then has no number of trials.
Attempt attemptFrom(std::size_t start, std::size_t images, const AskImage& ask);

/// `count` attempts from images drawn uniformly from all `images` of the second pass.
std::vector<Attempt> attempts(int count, std::size_t images, std::uint64_t seed, const AskImage& ask);

/// Mean and standard deviation over a sample (of the population, as a description of these attempts); 0 for
/// an empty one.
struct MeanStd {
  double mean = 0, std = 0;
  int count = 0;
};
MeanStd meanStd(const std::vector<double>& values);

/// A line of table I.
struct ProtocolFigures {
  int attempts = 0;
  int never = 0;   ///< attempts that found nothing before the drive ended
  MeanStd trials;  ///< of the attempts that found their right place
  MeanStd trackings;
  int accepted = 0, wrong = 0;        ///< images
  std::array<int, kMisses> misses{};  ///< images not accepted
  std::array<int, kMisses> ends{};    ///< attempts by their end, once located
  /// Wrong ones of the accepted images.
  double wrongShare() const { return accepted > 0 ? static_cast<double>(wrong) / accepted : 0.0; }
};
ProtocolFigures figuresOf(const std::vector<Attempt>& attempts);

}  // namespace engram::apps
