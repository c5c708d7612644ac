// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/text.h"

#include "engram/base/config.h"
#include "engram/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace engram::base {
namespace {

using namespace std::string_literals;

TEST(Quoted, LeavesPlainTextAlone) {
  EXPECT_EQ(base::quoted("office"), "'office'");
  EXPECT_EQ(base::quoted(""), "''");
  EXPECT_EQ(base::quoted("Büro 3 – 漢字 🗺"), "'Büro 3 – 漢字 🗺'");
  EXPECT_EQ(printable("C:\\n"), "C:\\n");
}

TEST(Quoted, EscapesWhatATerminalWouldObey) {
  EXPECT_EQ(base::quoted("a\x1b[2Jb\n\t\r"), "'a\\x1b[2Jb\\n\\t\\r'");
  EXPECT_EQ(base::quoted("\0x\x7f"s), "'\\x00x\\x7f'");
  EXPECT_EQ(base::quoted("\xc2\x9b"), "'\\xc2\\x9b'") << "the control sequence introducer of C1";
  EXPECT_EQ(base::quoted("\u202Egpj.exe"), "'\\xe2\\x80\\xaegpj.exe'") << "written from right to left";
}

TEST(Quoted, EscapesBytesThatAreNotUtf8) {
  EXPECT_EQ(base::quoted("\xff"), "'\\xff'");
  EXPECT_EQ(base::quoted("\xc3"), "'\\xc3'") << "cut";
  EXPECT_EQ(base::quoted("\xc3z"), "'\\xc3z'") << "the next character is not swallowed";
  EXPECT_EQ(base::quoted("\xc0\xaf"), "'\\xc0\\xaf'") << "overlong";
  EXPECT_EQ(base::quoted("\xe0\x80\xaf"), "'\\xe0\\x80\\xaf'") << "overlong";
  EXPECT_EQ(base::quoted("\xed\xa0\x80"), "'\\xed\\xa0\\x80'") << "a surrogate";
  EXPECT_EQ(base::quoted("\xf4\x90\x80\x80"), "'\\xf4\\x90\\x80\\x80'") << "beyond the last code";
}

TEST(Quoted, ShortensLongText) {
  EXPECT_EQ(printable(std::string(80, 'x')), std::string(80, 'x'));
  EXPECT_EQ(printable(std::string(81, 'x')), std::string(79, 'x') + "…");
  EXPECT_EQ(printable(std::string(100'000'000, 'x')), std::string(79, 'x') + "…");
  std::string umlauts, shown;
  for (int i = 0; i < 81; ++i) umlauts += "ü";
  for (int i = 0; i < 79; ++i) shown += "ü";
  EXPECT_EQ(printable(umlauts), shown + "…") << "never in the middle of a character";
}

/// Values, keys, sections and lines of a file: none is echoed whole, nor obeyed by the terminal.
TEST(Quoted, MessagesOfTheConfigurationAreShortAndPlain) {
  struct Robot {
    int wheels = 2;
    bool lamp = false;
    std::string drive = "diff";
    void describe(Params& p) {
      p.add("wheels", wheels, "number of wheels");
      p.add("lamp", lamp, "whether the lamp is on");
      p.addChoice("drive", drive, "kind of drive", {"diff", "omni"});
    }
  };
  const std::string huge = "\x1b[2J" + std::string(10'000'000, 'x');
  for (const std::string& text :
       {"[robot]\nwheels = " + huge, "[robot]\nlamp = " + huge, "[robot]\ndrive = " + huge,
        "[robot]\n" + huge + " = 1", "[" + huge + "]\na = 1", "[robot]\n" + huge, "[robot" + huge,
        "[robot]\n" + huge + " = 1\n" + huge + " = 1"}) {
    Robot robot;
    Config config;
    config.bind("robot", robot);
    std::string message;
    try {
      config.read(IniFile::parse(text, "r.ini"));
    } catch (const ConfigError& e) {
      message = e.what();
    }
    EXPECT_FALSE(message.empty()) << text.substr(0, 20);
    EXPECT_LT(message.size(), 400u) << text.substr(0, 20);
    EXPECT_EQ(message.find('\x1b'), std::string::npos) << text.substr(0, 20);
    EXPECT_NE(message.find("\\x1b[2Jxxx"), std::string::npos) << message;
  }
}

TEST(ForTerminal, KeepsLinesAndLength) {
  EXPECT_EQ(forTerminal("a\n\tb\x1b[2J\r\xff\u202E"), "a\n\tb\\x1b[2J\\r\\xff\\xe2\\x80\\xae");
  EXPECT_EQ(forTerminal(std::string(200, 'x')), std::string(200, 'x'));
}

}  // namespace
}  // namespace engram::base
