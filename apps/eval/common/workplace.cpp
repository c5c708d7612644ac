// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/workplace.h"

#include "engram/base/parallel.h"
#include "engram/base/progress.h"

#include <filesystem>
#include <mutex>

namespace engram::apps {
namespace fs = std::filesystem;

std::string Workplace::file(const std::string& name) const { return (fs::path(folder) / name).string(); }

std::string Workplace::subfolder(const std::string& name) const {
  fs::create_directories(file(name));
  return file(name);
}

void runJobs(const Workplace& place, const std::string& what, std::size_t n,
             const std::function<void(std::size_t)>& job) {
  base::Progress shown(place.progress, what);
  std::mutex mutex;
  std::size_t done = 0;
  shown.update(0, 0);
  base::parallelFor(n, place.threads, [&](std::size_t k) {
    job(k);
    const std::lock_guard lock(mutex);
    ++done;
    shown.update(static_cast<double>(done) / static_cast<double>(n), done);
  });
}

void runJobs(const Workplace& place, const std::vector<std::function<void()>>& jobs) {
  runJobs(place, "experiments", jobs.size(), [&](std::size_t k) { jobs[k](); });
}

}  // namespace engram::apps
