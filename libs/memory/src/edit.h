// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/memory/place_memory.h"

#include <functional>
#include <span>
#include <vector>

namespace engram::memory {

/// The view as a memory stores it: descriptors quantised.
types::Features asStored(const types::Features& view);

/// An empty memory for descriptors of this view.
PlaceMemory emptyMemory(const types::Features& view);

/// Appends the features of a stored view that are not matched and have no near-duplicate among the features
/// known before, so that the order of the view does not matter (F-E4). A second copy would make both fail the
/// ratio test for ever.
/// @param stateOf state of feature i of the view; the id is set here.
/// @returns the number of features added.
int insertUnmatched(PlaceMemory& memory, const types::Features& stored, std::span<const types::Match> matches,
                    double duplicateDistance, const std::function<FeatureState(std::size_t)>& stateOf);

/// Removes all features but those marked. @returns the number of features removed.
int keepOnly(PlaceMemory& memory, const std::vector<bool>& keep);

/// The FSH divided by its maximum (F-E9).
std::vector<float> normalisedFsh(const PlaceMemory& memory);

/// One update older, every feature of it.
void ageAll(PlaceMemory& memory);

}  // namespace engram::memory
