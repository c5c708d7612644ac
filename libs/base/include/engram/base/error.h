// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

namespace engram::base {

/// Bad input: a file, a key, a value. The message names it and says what to do. Programs print it and exit
/// with 1.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A configuration that cannot be used. The message names file, section and key.
class ConfigError : public Error {
 public:
  using Error::Error;
};

}  // namespace engram::base
