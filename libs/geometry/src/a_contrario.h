// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace engram::geometry {

/// log10 of the expected number of models that unrelated matches would support as well as this one
/// (Desolneux, Moisan & Morel 2000): the number of models that samples of n matches can propose, times the
/// binomial probability that `inliers` or more of them agree by accident.
/// @param inlierProbability that an unrelated match agrees with a model, in [0, 1].
/// @param modelsPerSample solutions of the minimal solver.
double log10FalseAlarms(int matches, int inliers, double inlierProbability, int sampleSize = 2,
                        int modelsPerSample = 2);

}  // namespace engram::geometry
