// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "words/words_world.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace engram::apps {

/// The figures of engram-eval words on the simulator, beside those of the paper.
nlohmann::json toJson(const WordsWorldResult& result);
std::string toText(const WordsWorldResult& result);

/// One line a building; a closure; a setting and transition; an attempt.
std::string mappingCsv(const WordsWorldResult& result);
std::string closuresCsv(const WordsWorldResult& result);
std::string localisationCsv(const WordsWorldResult& result);
std::string attemptsCsv(const WordsWorldResult& result);

/// @param settings the configuration in force
std::string toHtml(const WordsWorldResult& result, const WordsPlan& plan, const WordsWorldParams& params,
                   const std::string& settings, std::uint64_t seed);

}  // namespace engram::apps
