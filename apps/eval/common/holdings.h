// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"

#include <nlohmann/json_fwd.hpp>

#include <vector>

namespace engram::apps {

/// What a contender's places hold.
struct Holdings {
  double longTerm = 0, shortTerm = 0;            ///< features a place, mean
  double longTermSigma = 0, shortTermSigma = 0;  ///< over the places
  double bytesPerPlace = 0;                      ///< as stored in a map file

  bool operator==(const Holdings&) const = default;
};

/// Of at least one place.
Holdings holdingsOf(const std::vector<const memory::PlaceMemory*>& places);

/// For the files that an experiment keeps; `holdingsFrom` takes an object that may hold more.
nlohmann::json toJson(const Holdings& holdings);
Holdings holdingsFrom(const nlohmann::json& object);

struct MeanSigma {
  double mean = 0, sigma = 0;
};
/// 0 and 0 for no values; sigma is that of these values, not of a population they were drawn from.
MeanSigma meanAndSigma(const std::vector<double>& values);

}  // namespace engram::apps
