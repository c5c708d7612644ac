// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/apps/checks.h"

#include "program_run.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <ostream>

namespace engram::apps {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// A program with one option of each kind, which prints what it got.
class Numbers final : public Program {
 public:
  std::string name() const override { return "numbers"; }
  std::string description() const override { return "Takes numbers"; }
  std::string examples() const override { return "  numbers --square 0.03\n"; }
  void declare(CLI::App& app) override {
    app.add_option("--square", square_, "side")->check(positive());
    app.add_option("--radius", radius_, "radius")->check(notNegative());
    app.add_option("--loss", loss_, "share")->check(between(0, 1));
    app.add_option("--images", images_, "how many")->check(wholeFrom(1));
    app.add_option("--quality", quality_, "quality")->check(wholeBetween(1, 100));
  }
  int run(std::ostream& out, std::ostream&) override {
    out << square_ << ' ' << radius_ << ' ' << loss_ << ' ' << images_ << ' ' << quality_;
    return kOk;
  }

 private:
  double square_ = 1, radius_ = 1, loss_ = 1;
  std::size_t images_ = 1;
  int quality_ = 1;
};

RunResult run(const std::vector<std::string>& arguments) { return runAs<Numbers>(arguments); }

/// No person counts more digits than these.
bool hasLongNumber(const std::string& text) {
  std::size_t digits = 0;
  return std::any_of(text.begin(), text.end(), [&](unsigned char c) {
    digits = std::isdigit(c) != 0 ? digits + 1 : 0;
    return digits > 20;
  });
}

void refuses(const std::string& option, const std::string& value, const std::string& message) {
  const RunResult result = run({option, value});
  EXPECT_EQ(result.code, kUsage) << option << ' ' << value;
  EXPECT_THAT(result.err, AllOf(HasSubstr(option + ": '"), HasSubstr(message)));
  EXPECT_FALSE(hasLongNumber(result.err)) << result.err;
}

TEST(Checks, TakeNumbersWithinTheirBounds) {
  EXPECT_EQ(
      run({"--square", "+0.03", "--radius", "0", "--loss", "1", "--images", "7", "--quality", "100"}).out,
      "0.03 0 1 7 100");
  EXPECT_EQ(run({"--square", "3e-2", "--images", "+2"}).out, "0.03 1 1 2 1");
}

TEST(Checks, KnowADecimalComma) {
  refuses("--square", "0,03", "'0,03' is not a number: the decimal sign is a point, 0.03");
  refuses("--loss", "0,5", "the decimal sign is a point, 0.5");
  refuses("--quality", "90,5", "'90,5' is not a whole number: the decimal sign is a point, 90.5");
}

TEST(Checks, SayTheBoundAsAPersonWould) {
  refuses("--square", "0", "'0' is out of range: must be > 0");
  refuses("--square", "-1", "must be > 0");
  refuses("--radius", "-0.5", "must be >= 0");
  refuses("--loss", "1.5", "must be in [0, 1]");
  refuses("--images", "0", "must be >= 1");
  refuses("--quality", "101", "must be in [1, 100]");
  refuses("--quality", "99999999999999", "must be in [1, 100]");
}

TEST(Checks, RefuseWhatIsNoNumber) {
  for (const std::string option : {"--square", "--radius", "--loss"})
    for (const std::string value : {"nan", "inf", "-inf", "x", "1x", "1e999", "1,2,3", ""})
      EXPECT_EQ(run({option + "=" + value}).code, kUsage) << option << ' ' << value;
  refuses("--square", "nan", "'nan' is not a number");
  refuses("--images", "1.5", "'1.5' is not a whole number");
  refuses("--square", std::string(5000, 'y'), "y…' is not a number");
}

TEST(Checks, HelpSaysTheBounds) {
  const RunResult help = run({"--help"});
  EXPECT_THAT(help.out,
              AllOf(HasSubstr("> 0"), HasSubstr(">= 0"), HasSubstr("in [0, 1]"), HasSubstr("in [1, 100]")));
  EXPECT_FALSE(hasLongNumber(help.out));
}

}  // namespace
}  // namespace engram::apps
