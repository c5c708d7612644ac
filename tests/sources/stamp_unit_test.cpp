// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/sources/stamp_unit.h"

#include <gmock/gmock.h>

#include <cmath>

namespace engram::sources {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::vector<std::pair<StampUnit, double>> kPerSecond{{StampUnit::kSeconds, 1.0},
                                                           {StampUnit::kMilliseconds, 1e3},
                                                           {StampUnit::kMicroseconds, 1e6},
                                                           {StampUnit::kNanoseconds, 1e9}};

/// Stamps of `n` images, `step` [s] apart from `start` [s], as a file in another unit has them.
std::vector<double> drive(double start, double step, double perSecond, int n = 20) {
  std::vector<double> stamps;
  for (int i = 0; i < n; ++i) stamps.push_back((start + step * i) * perSecond);
  return stamps;
}

TEST(StampUnit, TimesSince1970TellTheUnit) {
  for (const auto& [unit, perSecond] : kPerSecond)
    for (const double start : {8e8, 1.40371527e9, 1.7e9, 4e9})
      for (const double step : {0.001, 0.0333, 0.1, 1.0, 10.0, 600.0}) {
        const auto reading = tellStampUnit(drive(start, step, perSecond));
        EXPECT_EQ(reading.unit, unit) << start << ' ' << step << ' ' << perSecond;
        EXPECT_THAT(reading.why, HasSubstr("since 1970"));
      }
  EXPECT_EQ(tellStampUnit(drive(1.7e9, 7200.0, 1)).unit, StampUnit::kSeconds);  // a picture every two hours
  EXPECT_EQ(tellStampUnit(std::vector{1.7e18}).unit, StampUnit::kNanoseconds);
}

TEST(StampUnit, OtherTimesAreToldByTheRateOfTheImages) {
  for (const auto& [unit, perSecond] : kPerSecond)
    for (const double start : {0.0, 12.5, 5000.0})
      for (const double step : {0.02, 1.0 / 30, 0.1, 0.5, 1.0})
        EXPECT_EQ(tellStampUnit(drive(start, step, perSecond)).unit, unit)
            << start << ' ' << step << ' ' << perSecond;
}

TEST(StampUnit, TimeSincePowerOnIsNoTimeSince1970) {
  // Half an hour in nanoseconds has as many digits as today in milliseconds.
  for (const double step : {1.0 / 60, 1.0 / 30, 0.1, 0.5})
    EXPECT_EQ(tellStampUnit(drive(1700.0, step, 1e9)).unit, StampUnit::kNanoseconds) << step;
}

TEST(StampUnit, WhatItCouldBeElseIsSaid) {
  const auto ambiguous = tellStampUnit(drive(0, 33, 1));
  EXPECT_EQ(ambiguous.unit, StampUnit::kMilliseconds);
  EXPECT_THAT(ambiguous.why, AllOf(HasSubstr("taken for milliseconds: 0.033 s lie between images"),
                                   HasSubstr("in s it would be 33 s")));
  const auto seconds = tellStampUnit(drive(0, 5, 1));
  EXPECT_EQ(seconds.unit, StampUnit::kSeconds);
  EXPECT_THAT(seconds.why, HasSubstr("in ms it would be 0.005 s"));
  EXPECT_THAT(tellStampUnit(drive(0, 0.1, 1)).why, Not(HasSubstr("it would be")));
}

TEST(StampUnit, WildAndRepeatedStampsDoNotDecide) {
  auto stamps = drive(1.7e9, 0.1, 1e3);
  stamps[4] = 0;
  stamps[5] = 1.7e18;
  stamps[9] = stamps[8];
  stamps[10] = -3;
  EXPECT_EQ(tellStampUnit(stamps).unit, StampUnit::kMilliseconds);
  EXPECT_EQ(tellStampUnit(std::vector(20, 7.0)).unit, StampUnit::kSeconds);
  EXPECT_EQ(tellStampUnit({}).unit, StampUnit::kSeconds);
}

TEST(SecondsOf, LosesNoDigitThatADoubleCanHold) {
  EXPECT_EQ(secondsOf("1700000000123456789", StampUnit::kNanoseconds), 1700000000.123456789);
  EXPECT_EQ(secondsOf("1403715274302142976", StampUnit::kNanoseconds), 1403715274.302142976);
  EXPECT_EQ(secondsOf("1700000000123456", StampUnit::kMicroseconds), 1700000000.123456);
  EXPECT_EQ(secondsOf("1700000000123.5", StampUnit::kMilliseconds), 1700000000.1235);
  EXPECT_EQ(secondsOf("0.1", StampUnit::kSeconds), 0.1);
  EXPECT_EQ(secondsOf("1.5e3", StampUnit::kMilliseconds), 1.5);
  EXPECT_EQ(secondsOf("1.5E+3", StampUnit::kSeconds), 1500.0);
  EXPECT_EQ(secondsOf("-20", StampUnit::kMicroseconds), -20e-6);
  // Every nanosecond would be too much for a double, but never does the way over 1e18 lose what it could
  // hold.
  for (int i = 0; i < 1000; ++i) {
    const std::string fraction = std::to_string(100000000 + 899999 * i);
    EXPECT_EQ(secondsOf("1700000000" + fraction, StampUnit::kNanoseconds),
              std::stod("1700000000." + fraction));
  }
}

TEST(SecondsOf, TakesNothingButWholeNumbers) {
  for (const char* text : {"", "x", "1x", "1e", "1ex", "nan", "inf", "1,5", "1 2", "1e999", "1e2e3", "--1"})
    EXPECT_EQ(secondsOf(text, StampUnit::kMilliseconds), std::nullopt) << text;
}

TEST(StampUnit, HasNames) {
  for (const auto& name : stampUnitNames()) EXPECT_EQ(toString(stampUnitOf(name)), name);
  EXPECT_EQ(stampUnitNames(), (std::vector<std::string>{"s", "ms", "us", "ns"}));
  EXPECT_EQ(stampUnitOf("min"), StampUnit::kAuto);
}

}  // namespace
}  // namespace engram::sources
