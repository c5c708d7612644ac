// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/experiment.h"

#include "engram/apps/config_file.h"
#include "engram/apps/shipped_config.h"
#include "engram/base/atomic_file.h"

#include <filesystem>
#include <ostream>

namespace engram::apps {
namespace fs = std::filesystem;

std::string finished(charts::Page& page, const std::string& settings, std::uint64_t seed, bool timed) {
  page.heading("What made this page");
  page.paragraph("Seed " + std::to_string(seed) + ". The same command gives the same figures" +
                 (timed ? ", but for processor times." : "."));
  page.preformatted(settings, "configuration");
  return page.html();
}

base::IniFile configOf(const std::string& file, const std::vector<std::string>& overrides) {
  base::IniFile ini = file.empty() ? base::IniFile::parse("", "command line") : loadConfig(file);
  for (const auto& assignment : overrides) ini.override(assignment);
  return ini;
}

pipeline::PipelineParams shippedPipeline(const std::string& name) {
  pipeline::PipelineParams params;
  base::Config config;
  params.bind(config);
  config.read(shippedConfig(name));
  params.camera.file.clear();
  return params;
}

void Experiment::declare(CLI::App& command) {
  options_.declare(command);
  declareMore(command);
}

void Experiment::declareMore(CLI::App&) {}
void Experiment::adjust(const base::IniFile&) {}
void Experiment::check() {}
std::string Experiment::identity() const { return "# seed = " + std::to_string(options_.seed) + "\n"; }

std::string Experiment::seedAndSize() const {
  return "# seed = " + std::to_string(options_.seed) + (options_.quick ? ", quick\n" : "\n");
}

std::string Experiment::readConfig() {
  base::Config config;
  configure(config);
  const base::IniFile ini = configOf(options_.config, options_.overrides);
  config.read(ini);
  adjust(ini);
  return config.dump();
}

int Experiment::run(std::ostream& out, std::ostream& err) {
  const std::string settings = readConfig();
  if (options_.dump) {
    out << settings;
    return kOk;
  }
  check();
  claimFolder(options_, settings + "\n" + identity(), results());
  const Workplace place{options_.folder, options_.seed, options_.threadsInUse(),
                        options_.quiet ? nullptr : &err};
  const Findings findings = measure(place, settings);
  write(findings);
  if (options_.quiet) return findings.code;
  out << findings.summary;
  if (!findings.report.empty()) out << "report: " << place.file(findings.report) << "\n";
  return findings.code;
}

void Experiment::write(const Findings& findings) const {
  for (const auto& [name, text] : findings.files)
    base::writeText((fs::path(options_.folder) / name).string(), text, true);
  writeJson(options_.json, findings.figures);
}

}  // namespace engram::apps
