// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/method_run_file.h"

#include "common/kept_file.h"

#include <cmath>

namespace engram::apps {
namespace {

using nlohmann::json;

/// Errors as whole thousandths of a place: short, and the same on every machine.
json thousandths(const std::vector<float>& values) {
  json list = json::array();
  for (const float v : values) list.push_back(std::lround(1000.0 * static_cast<double>(v)));
  return list;
}

std::vector<float> fromThousandths(const json& list) {
  std::vector<float> values;
  for (const auto& v : list) values.push_back(static_cast<float>(v.get<double>() / 1000.0));
  return values;
}

json toJson(const UpdateState& u) {
  json j = toJson(u.holdings);
  j.update({{"views", u.learning.views},
            {"accepted", u.learning.accepted},
            {"wrong", u.learning.wrong},
            {"learnt", u.learning.learnt}});
  return j;
}

UpdateState updateFrom(const json& j) {
  UpdateState u;
  u.holdings = holdingsFrom(j);
  u.learning = {j.at("views").get<int>(), j.at("accepted").get<int>(), j.at("wrong").get<int>(),
                j.at("learnt").get<int>()};
  return u;
}

}  // namespace

void writeMethodRun(const std::string& path, const MethodRun& run) {
  json updates = json::array(), cells = json::array();
  for (const auto& u : run.updates) updates.push_back(toJson(u));
  for (const auto& c : run.cells)
    cells.push_back({{"condition", c.condition},
                     {"update", c.update},
                     {"interpolated", thousandths(c.interpolated)},
                     {"whole", thousandths(c.whole)}});
  writeKept(path, {{"method", run.method}, {"updates", updates}, {"cells", cells}});
}

MethodRun readMethodRun(const std::string& path) {
  return readKept(path, [](const json& file) {
    MethodRun run;
    run.method = file.at("method").get<std::string>();
    for (const auto& u : file.at("updates")) run.updates.push_back(updateFrom(u));
    for (const auto& c : file.at("cells"))
      run.cells.push_back({c.at("condition").get<std::string>(), c.at("update").get<int>(),
                           fromThousandths(c.at("interpolated")), fromThousandths(c.at("whole"))});
    return run;
  });
}

}  // namespace engram::apps
