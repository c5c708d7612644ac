// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/features/extractor.h"

#include <memory>

namespace engram::features {

std::unique_ptr<Extractor> makeSiftExtractor(const ExtractorParams& params);
std::unique_ptr<Extractor> makeAkazeExtractor(const ExtractorParams& params);
std::unique_ptr<Extractor> makeOrbExtractor(const ExtractorParams& params);

}  // namespace engram::features
