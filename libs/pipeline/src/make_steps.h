// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/pipeline/recipe.h"
#include "steps.h"

namespace engram::pipeline {

/// The strategies that a recipe names, for a run. Throws as the constructors of these.
Steps makeSteps(const Recipe& recipe, const Run& run);

}  // namespace engram::pipeline
