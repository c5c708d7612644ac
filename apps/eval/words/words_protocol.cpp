// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "words/words_protocol.h"

#include "engram/base/error.h"
#include "engram/base/rng.h"

#include <cmath>
#include <numeric>

namespace engram::apps {

const char* toString(Miss miss) {
  switch (miss) {
    case Miss::kGeometry:
      return "geometry refused";
    case Miss::kUnsure:
      return "not probable enough";
    case Miss::kWrongGuess:
      return "wrong best guess";
    case Miss::kWrongAccept:
      return "wrong place accepted";
    case Miss::kEndOfDrive:
      return "end of the drive";
  }
  return "?";
}

Miss missOf(const PassAnswer& answer) {
  if (answer.accepted) return Miss::kWrongAccept;
  if (!answer.bestGuessRight) return Miss::kWrongGuess;
  return answer.verified ? Miss::kGeometry : Miss::kUnsure;
}

Attempt attemptFrom(std::size_t start, std::size_t images, const AskImage& ask) {
  Attempt a;
  a.start = start;
  for (std::size_t i = start; i < images; ++i) {
    const PassAnswer answer = ask(i, i == start);
    const bool good = answer.accepted && answer.right;
    a.accepted += answer.accepted;
    a.wrong += answer.accepted && !answer.right;
    if (!answer.accepted) ++a.misses[static_cast<std::size_t>(missOf(answer))];
    if (a.located && good) {
      ++a.trackings;
      continue;
    }
    if (!a.located) ++a.trials;
    if (a.located || (answer.accepted && !good)) {
      a.end = missOf(answer);
      return a;
    }
    a.located = good;
  }
  return a;
}

std::vector<Attempt> attempts(int count, std::size_t images, std::uint64_t seed, const AskImage& ask) {
  if (images == 0) throw base::Error("the second pass has no image to start from");
  base::Rng rng(seed);
  std::vector<Attempt> all;
  for (int k = 0; k < count; ++k)
    all.push_back(attemptFrom(rng.below(static_cast<std::uint32_t>(images)), images, ask));
  return all;
}

MeanStd meanStd(const std::vector<double>& values) {
  MeanStd m;
  m.count = static_cast<int>(values.size());
  if (values.empty()) return m;
  m.mean = std::accumulate(values.begin(), values.end(), 0.0) / m.count;
  double squares = 0;
  for (const double v : values) squares += (v - m.mean) * (v - m.mean);
  m.std = std::sqrt(squares / m.count);
  return m;
}

ProtocolFigures figuresOf(const std::vector<Attempt>& attempts) {
  ProtocolFigures f;
  std::vector<double> trials, trackings;
  for (const Attempt& a : attempts) {
    ++f.attempts;
    f.accepted += a.accepted;
    f.wrong += a.wrong;
    f.never += a.accepted == 0;
    for (std::size_t k = 0; k < kMisses; ++k) f.misses[k] += a.misses[k];
    if (!a.located) continue;
    trials.push_back(a.trials);
    trackings.push_back(a.trackings);
    ++f.ends[static_cast<std::size_t>(a.end)];
  }
  f.trials = meanStd(trials);
  f.trackings = meanStd(trackings);
  return f;
}

}  // namespace engram::apps
