// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "cpu.h"
#include "engram/features/extractor.h"

#include <memory>

namespace engram::features {

/// SURF (Bay, Ess, Tuytelaars & Van Gool 2008) with a given instruction set.
std::unique_ptr<Extractor> makeSurfExtractor(const ExtractorParams& params, SimdLevel level);

}  // namespace engram::features
