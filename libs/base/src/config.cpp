// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/config.h"

#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/base/text_file.h"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <sstream>

namespace engram::base {
namespace {

std::string trim(const std::string& s) {
  const auto first = s.find_first_not_of(" \t\r");
  if (first == std::string::npos) return {};
  return s.substr(first, s.find_last_not_of(" \t\r") - first + 1);
}

/// Cuts a comment: `#`, `;` or `//` at the start of the line or after white space, as MRPT does.
std::string withoutComment(const std::string& line) {
  for (std::size_t i = 0; i < line.size(); ++i) {
    const bool starts = i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t';
    const bool mark = line[i] == '#' || line[i] == ';' || line.compare(i, 2, "//") == 0;
    if (starts && mark) return line.substr(0, i);
  }
  return line;
}

std::size_t editDistance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

[[noreturn]] void fail(const std::string& origin, const std::string& what) {
  throw ConfigError(origin + ": " + what);
}

/// A configuration may be called through a link, or from anywhere: what it names lies where it lies itself.
std::string besides(const std::string& ini, const std::string& file) {
  namespace fs = std::filesystem;
  std::error_code status;
  const fs::path folder = fs::weakly_canonical(ini, status).parent_path();
  return status || file.empty() ? file : (folder / file).lexically_normal().string();
}

std::string hint(const std::string& nearest) {
  return nearest.empty() ? "; --dump-config lists the known ones" : "; did you mean '" + nearest + "'?";
}

}  // namespace

std::string nearestName(const std::string& name, const std::vector<std::string>& known) {
  std::string best;
  std::size_t bestDistance = std::max<std::size_t>(2, name.size() / 3) + 1;
  for (const auto& candidate : known) {
    if (name.size() >= candidate.size() + bestDistance) continue;  // spares the work for a huge name
    const std::size_t distance = editDistance(name, candidate);
    if (distance < bestDistance) {
      bestDistance = distance;
      best = candidate;
    }
  }
  return best;
}

IniFile IniFile::load(const std::string& path) {
  try {
    IniFile ini = parse(readTextFile(path), path);
    for (auto& [name, section] : ini.sections_)
      if (const auto file = section.find("file"); file != section.end())
        file->second.text = besides(path, file->second.text);
    return ini;
  } catch (const ConfigError&) {
    throw;
  } catch (const Error& e) {
    throw ConfigError(e.what());
  }
}

IniFile IniFile::parse(const std::string& text, const std::string& name) {
  IniFile ini;
  ini.name_ = name;
  std::istringstream in(text);
  std::string line, section;
  for (int number = 1; std::getline(in, line); ++number) {
    const std::string origin = name + ":" + std::to_string(number);
    const std::string content = trim(withoutComment(line));
    if (content.empty()) continue;
    if (content.front() == '[') {
      if (content.back() != ']') fail(origin, base::quoted(content) + " lacks the closing ']'");
      section = trim(content.substr(1, content.size() - 2));
      ini.sections_[section];
      continue;
    }
    const auto equals = content.find('=');
    if (equals == std::string::npos)
      fail(origin, base::quoted(content) + " is neither [section] nor key = value");
    if (section.empty()) fail(origin, "a key before the first [section]");
    const std::string key = trim(content.substr(0, equals));
    const auto [at, isNew] = ini.sections_[section].insert({key, {trim(content.substr(equals + 1)), origin}});
    if (!isNew)
      fail(origin, std::string("[") + printable(section) + "] " + printable(key) + " was set before, at " +
                       at->second.origin);
  }
  return ini;
}

void IniFile::override(const std::string& assignment) {
  const auto equals = assignment.find('=');
  const auto dot = assignment.find('.');
  if (equals == std::string::npos || dot == std::string::npos || dot > equals)
    throw ConfigError("--set " + base::quoted(assignment) + ": expected section.key=value");
  const std::string section = trim(assignment.substr(0, dot));
  const std::string key = trim(assignment.substr(dot + 1, equals - dot - 1));
  sections_[section][key] = {trim(assignment.substr(equals + 1)), "--set"};
}

std::optional<IniFile::Section> IniFile::take(const std::string& section) {
  const auto at = sections_.find(section);
  if (at == sections_.end()) return std::nullopt;
  Section taken = std::move(at->second);
  sections_.erase(at);
  return taken;
}

Params& Config::addSection(const std::string& name) {
  for (auto& bound : sections_)
    if (bound.name == name) return bound.params;
  sections_.push_back({name, {}});
  return sections_.back().params;
}

void Config::read(const IniFile& ini) {
  std::vector<std::string> sectionNames;
  for (const auto& bound : sections_) sectionNames.push_back(bound.name);

  for (const auto& [sectionName, section] : ini.sections()) {
    const auto bound = std::find_if(sections_.begin(), sections_.end(),
                                    [&, &wanted = sectionName](const Bound& b) { return b.name == wanted; });
    if (bound == sections_.end()) {
      const std::string origin = section.empty() ? ini.name() : section.begin()->second.origin;
      fail(origin,
           "unknown section [" + printable(sectionName) + "]" + hint(nearestName(sectionName, sectionNames)));
    }
    std::vector<std::string> keys;
    for (const auto& field : bound->params.fields()) keys.push_back(field.key);
    for (const auto& [key, value] : section) {
      const auto at = std::find(keys.begin(), keys.end(), key);
      const std::string where = "[" + sectionName + "] " + printable(key);
      if (at == keys.end()) fail(value.origin, where + ": unknown key" + hint(nearestName(key, keys)));
      const auto& field = bound->params.fields()[static_cast<std::size_t>(at - keys.begin())];
      try {
        field.parse(value.text);
        field.check();
      } catch (const ConfigError& e) {
        fail(value.origin, where + ": " + e.what());
      }
    }
  }
}

std::string Config::dump(const WhyInert& whyInert) const {
  std::ostringstream out;
  for (const auto& bound : sections_) {
    out << "[" << bound.name << "]\n";
    for (const auto& field : bound.params.fields()) {
      const std::string inert = whyInert ? whyInert(bound.name, field.key) : std::string();
      out << "# " << field.help << "\n";
      if (!inert.empty()) out << "# without effect: " << inert << "\n# ";
      out << field.key << " = " << field.print() << "\n";
    }
    out << "\n";
  }
  return out.str();
}

}  // namespace engram::base
