// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/experiment_folder.h"
#include "common/workplace.h"
#include "engram/apps/program.h"
#include "engram/base/config.h"
#include "engram/charts/page.h"
#include "engram/pipeline/params.h"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

namespace engram::apps {

/// What an experiment hands on.
struct Findings {
  struct File {
    std::string name, text;
  };
  std::vector<File> files;  ///< for the folder
  nlohmann::json figures;   ///< for --json
  std::string summary;      ///< for a person
  std::string report = {};  ///< the file to look at; empty: none is named
  int code = kOk;           ///< exit code
};

/// A subcommand of engram-eval that repeats the experiments of a paper. The base class has what is the same
/// in all: options, configuration, the folder that is claimed and gone on in, and the files at the end.
class Experiment : public Program {
 public:
  void declare(CLI::App& command) final;
  /// In this order: configure(), adjust(), check(), the folder is claimed, measure(), results are written.
  int run(std::ostream& out, std::ostream& err) final;

 protected:
  const ExperimentOptions& options() const { return options_; }
  /// An identity for experiments whose size does not show in the configuration.
  std::string seedAndSize() const;

  /// Options of its own.
  virtual void declareMore(CLI::App& command);
  /// Sets the defaults, with regard to --quick, and binds what a configuration may change.
  virtual void configure(base::Config& config) = 0;
  /// After the configuration was read, before anybody sees it.
  virtual void adjust(const base::IniFile& ini);
  /// Throws for what is missing, before anything is written.
  virtual void check();
  /// What makes it another experiment beside the configuration: lines that begin with "# ".
  virtual std::string identity() const;
  /// The files that it writes, or may write, in the folder.
  virtual std::vector<std::string> results() const = 0;
  /// @param settings the configuration in force. Throws base::Interrupted; what is done then is kept.
  virtual Findings measure(const Workplace& place, const std::string& settings) = 0;

 private:
  std::string readConfig();
  void write(const Findings& findings) const;

  ExperimentOptions options_;
};

/// The page with, at its end, what made it. @param timed some of its figures are times, which differ
std::string finished(charts::Page& page, const std::string& settings, std::uint64_t seed, bool timed);

/// The configuration of an optional file with the overrides of the command line on top.
base::IniFile configOf(const std::string& file, const std::vector<std::string>& overrides);

/// A shipped configuration (see shipped_config.h) but for the camera that it names: an experiment has its
/// own.
pipeline::PipelineParams shippedPipeline(const std::string& name);

}  // namespace engram::apps
