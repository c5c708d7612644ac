// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace engram::apps {

/// Where an experiment works, and with what.
struct Workplace {
  std::string folder;  ///< of the results, and of what is kept for the next time
  std::uint64_t seed = 1;
  int threads = 1;
  std::ostream* progress = nullptr;  ///< null: nobody wants to see any

  /// A file of the folder.
  std::string file(const std::string& name) const;
  /// A folder in the folder, made if need be.
  std::string subfolder(const std::string& name) const;
};

/// Calls job(0) … job(n - 1) on the threads of the place, the first ones first, and says how many are done.
/// Rethrows the first exception.
void runJobs(const Workplace& place, const std::string& what, std::size_t n,
             const std::function<void(std::size_t)>& job);
/// The same for jobs of several kinds.
void runJobs(const Workplace& place, const std::vector<std::function<void()>>& jobs);

}  // namespace engram::apps
