// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/error.h"

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace engram::base {

/// Closed interval of legal values.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
};
inline Range atLeast(double low) { return {low, std::numeric_limits<double>::infinity()}; }

/// The fields of a parameter struct, bound by reference. A struct describes itself once:
///
///     struct FshParams {
///       double ltm_threshold = 0.7;
///       void describe(base::Params& p) { p.add("ltm_threshold", ltm_threshold, "FSH value from which …", {0,
///       1}); }
///     };
///
/// and that one list reads it from a file, checks its bounds and prints it.
class Params {
 public:
  struct Field {
    std::string key;
    std::string help;                               ///< meaning and unit, one line
    std::function<void(const std::string&)> parse;  ///< throws ConfigError with the reason only
    std::function<std::string()> print;
    std::function<void()> check;  ///< throws ConfigError with the reason only
  };

  void add(const std::string& key, double& value, const std::string& help, Range range = {});
  void add(const std::string& key, int& value, const std::string& help, Range range = {});
  void add(const std::string& key, bool& value, const std::string& help);
  void add(const std::string& key, std::string& value, const std::string& help);
  /// Radians in memory, degrees in the file; `degrees` bounds the latter.
  void addDegrees(const std::string& key, double& radians, const std::string& help, Range degrees = {});
  /// A strategy chosen by name.
  void addChoice(const std::string& key, std::string& value, const std::string& help,
                 const std::vector<std::string>& names);

  const std::vector<Field>& fields() const { return fields_; }

 private:
  std::vector<Field> fields_;
};

/// Throws ConfigError that names the key, its value and the bound. `params` has describe(Params&).
template <class T>
void validate(const T& params) {
  T copy = params;
  Params list;
  copy.describe(list);
  for (const auto& field : list.fields()) {
    try {
      field.check();
    } catch (const ConfigError& e) {
      throw ConfigError(field.key + ": " + e.what());
    }
  }
}

}  // namespace engram::base
