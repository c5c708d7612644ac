// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/run_jobs.h"

#include "engram/base/parallel.h"
#include "engram/base/progress.h"

#include <mutex>

namespace engram::apps {

void runJobs(const std::vector<std::function<void()>>& jobs, int threads, std::ostream* progress) {
  base::Progress shown(progress, "experiments");
  std::mutex mutex;
  std::size_t done = 0;
  shown.update(0, 0);
  base::parallelFor(jobs.size(), threads, [&](std::size_t k) {
    jobs[k]();
    const std::lock_guard lock(mutex);
    ++done;
    shown.update(static_cast<double>(done) / static_cast<double>(jobs.size()), done);
  });
}

}  // namespace engram::apps
