// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/types/features.h"
#include "engram/vocabulary/vocabulary_tree.h"

#include <CLI/CLI.hpp>

#include <iosfwd>
#include <string>
#include <vector>

namespace engram::apps {

/// engram-map train-vocabulary: a vocabulary tree from all that the places of some maps remember.
class TrainVocabularyCommand {
 public:
  void declare(CLI::App& command);
  int run(std::ostream& out, std::ostream& err);

 private:
  vocabulary::TreeParams readParams() const;
  std::vector<types::Descriptors> readMaps() const;

  std::vector<std::string> maps_, overrides_;
  std::string output_;
  bool overwrite_ = false, quiet_ = false, dump_ = false;
};

}  // namespace engram::apps
