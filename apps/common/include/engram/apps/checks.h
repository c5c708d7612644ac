// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace engram::apps {

/// Checks for numbers of the command line. Those of CLI11 let NaN pass and print bounds of 309 digits. These
/// name the text, say what it must be in the words of a person, and know a decimal comma when they see one.
CLI::Validator positive();                        ///< > 0
CLI::Validator notNegative();                     ///< >= 0
CLI::Validator between(double low, double high);  ///< both included
CLI::Validator wholeFrom(int low);                ///< whole numbers, >= low
CLI::Validator wholeBetween(int low, int high);   ///< whole numbers, both included

}  // namespace engram::apps
