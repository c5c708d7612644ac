// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <regex>
#include <string>
#include <vector>

namespace engram::charts {

/// Checks that tags are closed in order, attributes quoted and all entities known: what an XML parser would
/// ask for.
inline std::string whyNotWellFormed(const std::string& html, const std::string& from = "<html") {
  static const std::regex kTag(R"(<(/?)([a-zA-Z][a-zA-Z0-9]*)((\s+[a-zA-Z][\w-]*="[^"<]*")*)\s*(/?)>)");
  std::vector<std::string> open;
  std::size_t at = html.find(from);
  while ((at = html.find_first_of("<&", at)) != std::string::npos) {
    std::smatch m;
    const std::string rest = html.substr(at, 400000);
    if (html[at] == '&') {
      static const std::regex kEntity("&(amp|lt|gt|quot|#39);");
      if (!std::regex_search(rest, m, kEntity, std::regex_constants::match_continuous))
        return "entity: " + rest.substr(0, 20);
      at += 1;
      continue;
    }
    // By hand, as std::regex recurses for every character of a long attribute.
    const std::size_t end = rest.find('>');
    const std::string tag = rest.substr(0, end + 1);
    std::string shortTag = std::regex_replace(tag, std::regex("points=\"[^\"]{500,}\""), "points=\"\"");
    if (tag.size() > 2000) shortTag = tag.substr(0, tag.find("points=")) + "points=\"\"/>";
    if (!std::regex_match(shortTag, m, kTag)) return "tag: " + shortTag.substr(0, 200);
    const std::string name = m[2];
    if (m[1].length() > 0) {
      if (open.empty() || open.back() != name)
        return "closes " + name + " inside " + (open.empty() ? "nothing" : open.back());
      open.pop_back();
    } else if (m[5].length() == 0) {
      open.push_back(name);
    }
    at += end + 1;
  }
  return open.empty() ? "" : "open: " + open.back();
}

}  // namespace engram::charts
