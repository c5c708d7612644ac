// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/base/params.h"

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace engram::base {

/// A parsed `.ini` text in MRPT's syntax: `[section]`, `key = value`, comments after `#`, `;` or `//`.
/// Unlike MRPT's reader it reports duplicates, lines that are neither, and the line of every value.
class IniFile {
 public:
  struct Value {
    std::string text;
    std::string origin;  ///< "file.ini:12" or "--set"
  };
  using Section = std::map<std::string, Value>;

  static IniFile load(const std::string& path);  ///< a key `file` is relative to it, links resolved
  static IniFile parse(const std::string& text, const std::string& name);

  /// Applies `section.key=value` of the command line on top.
  void override(const std::string& assignment);

  /// Removes a section and hands it over; none when there is no such section.
  std::optional<Section> take(const std::string& section);

  const std::map<std::string, Section>& sections() const { return sections_; }
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::map<std::string, Section> sections_;
};

/// The whole configuration of a program: parameter structs bound to sections.
/// The bound structs must outlive this object.
class Config {
 public:
  template <class T>
  void bind(const std::string& section, T& params) {
    params.describe(addSection(section));
  }

  /// Sets the bound structs. Refuses unknown sections and keys (naming the nearest known one), text that is
  /// not wholly a number, and values out of range, with file, line, section and key.
  void read(const IniFile& ini);

  /// Why a key has no effect; empty when it has one. By section and key.
  using WhyInert = std::function<std::string(const std::string&, const std::string&)>;
  /// Every key in force with its meaning, readable by read(). Keys without effect are comments.
  std::string dump(const WhyInert& whyInert = {}) const;

 private:
  struct Bound {
    std::string name;
    Params params;
  };
  Params& addSection(const std::string& name);

  std::vector<Bound> sections_;  // in the order of bind(), which is the order of dump()
};

/// The name in `known` with the smallest edit distance to `name`; empty when none is near.
std::string nearestName(const std::string& name, const std::vector<std::string>& known);

}  // namespace engram::base
