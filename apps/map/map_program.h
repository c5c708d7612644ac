// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "copy_command.h"
#include "diff_command.h"
#include "engram/apps/program.h"
#include "index_command.h"
#include "keeper_commands.h"
#include "merge_command.h"
#include "train_vocabulary_command.h"

namespace engram::apps {

/// engram-map: looks into a map file, checks, copies, recovers and exports it, trains vocabularies on it; and
/// the tools of a keeper of maps, which alone write to one.
class MapProgram : public Program {
 public:
  std::string name() const override { return "engram-map"; }
  std::string description() const override {
    return "Look into a map of Engram, check, copy, recover and export it, compare two, keep one in order";
  }
  std::string examples() const override;
  void declare(CLI::App& app) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  int info(std::ostream& out, std::ostream& err) const;
  int check(std::ostream& out) const;
  int dump(std::ostream& out, std::ostream& err) const;
  int config(std::ostream& out) const;
  int exportMap(std::ostream& out) const;

  CLI::App *info_ = nullptr, *check_ = nullptr, *dump_ = nullptr, *export_ = nullptr, *train_ = nullptr,
           *indexOf_ = nullptr, *copyTo_ = nullptr, *recoverTo_ = nullptr, *config_ = nullptr,
           *diff_ = nullptr, *merge_ = nullptr;
  std::string map_, json_, format_, output_;
  TrainVocabularyCommand trainVocabulary_;
  IndexCommand index_;
  KeeperCommands keeper_;
  DiffCommand diffMaps_;
  MergeCommand mergeMaps_;
  CopyCommand copy_{CopyCommand::Kind::kCopy}, recover_{CopyCommand::Kind::kRecover};
  bool images_ = false, camera_ = false, overwrite_ = false, quiet_ = false;
};

}  // namespace engram::apps
