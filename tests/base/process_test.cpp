// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Threads, signals and the progress line.
#include "engram/base/interrupt.h"
#include "engram/base/parallel.h"
#include "engram/base/progress.h"
#include "engram/base/standard_descriptors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <iostream>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <unistd.h>

namespace engram::base {
namespace {

TEST(ParallelFor, CallsEveryIndexOnceOnAnyNumberOfThreads) {
  for (const int threads : {-1, 0, 1, 2, 3, 16}) {
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{5}, std::size_t{1000}}) {
      std::vector<std::atomic<int>> calls(n);
      parallelFor(n, threads, [&](std::size_t i) { ++calls[i]; });
      for (const auto& count : calls) ASSERT_EQ(count.load(), 1);
    }
  }
}

TEST(ParallelFor, GivesTheSameResultOnAnyNumberOfThreads) {
  const auto run = [](int threads) {
    std::vector<double> out(500);
    parallelFor(out.size(), threads, [&](std::size_t i) { out[i] = 1.0 / (1.0 + static_cast<double>(i)); });
    return out;
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(ParallelFor, RethrowsAnExceptionAndStops) {
  for (const int threads : {1, 4}) {
    std::atomic<int> calls{0};
    const auto body = [&](std::size_t i) {
      ++calls;
      if (i == 10) throw std::runtime_error("ten");
    };
    EXPECT_THAT([&] { parallelFor(1000000, threads, body); },
                testing::ThrowsMessage<std::runtime_error>("ten"));
    EXPECT_GE(calls.load(), 11);
    EXPECT_LT(calls.load(), 1000000);
  }
}

TEST(ParallelFor, ThrowsOneOfSeveralExceptions) {
  EXPECT_THROW(parallelFor(100, 4, [](std::size_t) { throw std::logic_error("any"); }), std::logic_error);
}

TEST(InterruptDeathTest, FirstSignalSetsTheFlagAndALaterOneEnds) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const int signal : {SIGINT, SIGTERM}) {
    EXPECT_EXIT(
        {
          installInterruptHandler();
          if (interrupted()) std::_Exit(10);
          std::raise(signal);
          std::raise(signal);  // `timeout` signals the process and its group
          std::_Exit(interrupted() ? 0 : 11);
        },
        testing::ExitedWithCode(0), "");
    EXPECT_EXIT(
        {
          installInterruptHandler();
          std::raise(signal);
          std::this_thread::sleep_for(std::chrono::milliseconds(600));
          std::raise(signal);
          std::_Exit(12);
        },
        testing::KilledBySignal(signal), "");
  }
}

TEST(InterruptDeathTest, AHangUpSetsTheFlagHoweverOftenItComes) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto hangUp = [](int exitWhenSet) {
    installInterruptHandler();
    std::raise(SIGHUP);
    std::raise(SIGHUP);  // of the terminal and of its shell
    std::_Exit(interrupted() ? exitWhenSet : 11);
  };
  EXPECT_EXIT(hangUp(0), testing::ExitedWithCode(0), "");
  EXPECT_EXIT(
      {
        std::signal(SIGHUP, SIG_IGN);  // nohup
        hangUp(12);
      },
      testing::ExitedWithCode(11), "");
}

TEST(StandardDescriptorsDeathTest, NoFileGetsTheNumberOfAStandardOne) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (int closed = 1; closed < 8; ++closed) {
    EXPECT_EXIT(
        {
          for (int i = 0; i < 3; ++i)
            if ((closed >> i & 1) != 0) ::close(i);
          openStandardDescriptors();
          const bool outFails = ::write(STDOUT_FILENO, "", 0) < 0;
          const bool asClosed = outFails == ((closed & 2) != 0);
          std::_Exit(asClosed && ::open("/dev/null", O_RDONLY) > 2 ? 0 : 1);
        },
        testing::ExitedWithCode(0), "")
        << closed;
  }
}

TEST(Progress, AsksTheStreamItWritesToWhetherItIsATerminal) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(master, 0);
  ASSERT_EQ(::grantpt(master) + ::unlockpt(master), 0);
  const int terminal = ::open(::ptsname(master), O_RDWR | O_NOCTTY), saved = ::dup(STDERR_FILENO);
  ASSERT_GE(terminal, 0);
  ::dup2(terminal, STDERR_FILENO);
  const bool err = isTerminal(std::cerr), other = isTerminal(std::ostringstream());
  ::dup2(saved, STDERR_FILENO);
  for (const int descriptor : {saved, terminal, master}) ::close(descriptor);
  EXPECT_TRUE(err);
  EXPECT_FALSE(other);
}

TEST(Progress, IsSilentWithoutAStreamAndBeforeItHasSomethingToSay) {
  std::ostringstream out;
  {
    Progress progress(&out, "reading");
    progress.update(0.1, 1);  // too soon after the start to be worth a line
    progress.finish();
    progress.update(0.9, 9);  // finished
  }
  EXPECT_EQ(out.str(), "");
  Progress silent(nullptr, "reading");
  EXPECT_NO_THROW(silent.update(0.5, 5));
}

}  // namespace
}  // namespace engram::base
