// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "memory/method_run_file.h"

#include "engram/apps/json_file.h"
#include "engram/base/atomic_file.h"
#include "engram/base/error.h"

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
  return {{"long_term", u.holdings.longTerm},
          {"long_term_sigma", u.holdings.longTermSigma},
          {"short_term", u.holdings.shortTerm},
          {"short_term_sigma", u.holdings.shortTermSigma},
          {"bytes_per_place", u.holdings.bytesPerPlace},
          {"views", u.learning.views},
          {"accepted", u.learning.accepted},
          {"wrong", u.learning.wrong},
          {"learnt", u.learning.learnt}};
}

UpdateState updateFrom(const json& j) {
  UpdateState u;
  u.holdings = {j.at("long_term").get<double>(), j.at("short_term").get<double>(),
                j.at("long_term_sigma").get<double>(), j.at("short_term_sigma").get<double>(),
                j.at("bytes_per_place").get<double>()};
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
  base::writeText(path, toText(json{{"method", run.method}, {"updates", updates}, {"cells", cells}}), true);
}

MethodRun readMethodRun(const std::string& path) {
  try {
    const json file = readJson(path);
    MethodRun run;
    run.method = file.at("method").get<std::string>();
    for (const auto& u : file.at("updates")) run.updates.push_back(updateFrom(u));
    for (const auto& c : file.at("cells"))
      run.cells.push_back({c.at("condition").get<std::string>(), c.at("update").get<int>(),
                           fromThousandths(c.at("interpolated")), fromThousandths(c.at("whole"))});
    return run;
  } catch (const json::exception& e) {
    throw base::Error(path + ": cannot be read (" + e.what() + "); remove it and it is measured again");
  }
}

}  // namespace engram::apps
