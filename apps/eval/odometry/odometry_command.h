// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engram/apps/program.h"
#include "engram/evaluation/drift.h"
#include "engram/sources/rawlog_source.h"
#include "odometry/odometry_run.h"

#include <nlohmann/json_fwd.hpp>

#include <iosfwd>
#include <string>
#include <vector>

namespace engram::apps {

/// engram-eval odometry: visual odometry from a stereo rawlog, against ground truth where there is one. It
/// needs no folder, keeps nothing, and a recording has no seed: it is no Experiment.
class OdometryCommand final : public Program {
 public:
  std::string name() const override { return "odometry"; }
  std::string description() const override;
  std::string examples() const override;
  void declare(CLI::App& command) override;
  int run(std::ostream& out, std::ostream& err) override;

 private:
  /// True when --dump-config was served.
  bool readConfig(std::ostream& out);
  void checkOutput() const;
  cameras::StereoRig rigOf(const sources::RawlogSource& source) const;
  void drive(sources::RawlogSource& source, std::ostream& err);
  void measureDrift();
  nlohmann::json figures() const;
  void writeFiles() const;

  std::string rawlog_, camera_, truth_, folder_, json_, config_;
  std::vector<std::string> overrides_;
  bool wheels_ = false, fitBody_ = false, dump_ = false, overwrite_ = false, quiet_ = false;
  int every_ = 1;
  sources::RawlogParams source_;
  odometry::OdometryParams odometry_;

  OdometryDrive drive_;
  odometry::StereoHealth health_;
  evaluation::Drift drift_;
  double bodyAngle_ = 0;  // [rad] of --fit-body
};

}  // namespace engram::apps
