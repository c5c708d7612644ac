// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/holdings.h"

#include "engram/store/feature_file.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace engram::apps {

Holdings holdingsOf(const std::vector<const memory::PlaceMemory*>& places) {
  Holdings h;
  std::vector<double> longTerm, shortTerm;
  for (const memory::PlaceMemory* place : places) {
    longTerm.push_back(static_cast<double>(place->longTerm().size()));
    shortTerm.push_back(static_cast<double>(place->features.size()) - longTerm.back());
    h.bytesPerPlace += static_cast<double>(store::storedBytes(*place));
  }
  h.longTerm = meanAndSigma(longTerm).mean;
  h.longTermSigma = meanAndSigma(longTerm).sigma;
  h.shortTerm = meanAndSigma(shortTerm).mean;
  h.shortTermSigma = meanAndSigma(shortTerm).sigma;
  h.bytesPerPlace /= static_cast<double>(places.size());
  return h;
}

nlohmann::json toJson(const Holdings& h) {
  return {{"long_term", h.longTerm},
          {"long_term_sigma", h.longTermSigma},
          {"short_term", h.shortTerm},
          {"short_term_sigma", h.shortTermSigma},
          {"bytes_per_place", h.bytesPerPlace}};
}

Holdings holdingsFrom(const nlohmann::json& object) {
  const auto number = [&](const char* key) { return object.at(key).get<double>(); };
  return {number("long_term"), number("short_term"), number("long_term_sigma"), number("short_term_sigma"),
          number("bytes_per_place")};
}

MeanSigma meanAndSigma(const std::vector<double>& values) {
  MeanSigma m;
  const double n = std::max<double>(1.0, static_cast<double>(values.size()));
  for (const double v : values) m.mean += v / n;
  for (const double v : values) m.sigma += (v - m.mean) * (v - m.mean) / n;
  m.sigma = std::sqrt(m.sigma);
  return m;
}

}  // namespace engram::apps
