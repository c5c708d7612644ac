// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/table.h"
#include "words/words_world.h"

#include <string>

namespace engram::apps {

/// The figures of engram-eval words on the simulator, beside those of the paper.
nlohmann::json toJson(const WordsWorldResult& result);
std::string toText(const WordsWorldResult& result);

/// One row a building; a closure; a setting and transition, twice; an attempt.
ResultTable mappingTable(const WordsWorldResult& result);
ResultTable closureTable(const WordsWorldResult& result);
ResultTable localisationTable(const WordsWorldResult& result);
ResultTable endsTable(const WordsWorldResult& result);
ResultTable attemptTable(const WordsWorldResult& result);

/// @param settings the configuration in force
std::string toHtml(const WordsWorldResult& result, const WordsPlan& plan, const WordsWorldParams& params,
                   const std::string& settings, std::uint64_t seed);

}  // namespace engram::apps
