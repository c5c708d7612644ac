// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Says where the images of a rawlog were taken: localise MAP RAWLOG
#include <engram/base/config.h>
#include <engram/pipeline/pipeline.h>
#include <engram/sources/rawlog_source.h>
#include <engram/store/map_file.h>

#include <exception>
#include <iostream>

int main(int argc, char** argv) try {
  using namespace engram;
  if (argc != 3) throw base::Error("usage: localise MAP RAWLOG");
  const auto file = store::MapFile::open(argv[1], store::Access::kReadOnly);

  // The map holds the configuration that it was made with.
  pipeline::PipelineParams params;
  sources::RawlogParams source;
  base::Config config;
  config.bind("source", source);
  params.bind(config);
  config.read(base::IniFile::parse(file.header().parameters, argv[1]));

  pipeline::Pipeline localiser(params, file.load(), pipeline::Use::kFrozen);
  const auto images = sources::openRawlog(argv[2], source);
  while (const auto frame = images->next()) {
    const types::FrameReport report = localiser.process(*frame);
    std::cout << frame->index << ": " << types::toString(report.outcome);
    for (const types::Hypothesis& h : report.hypotheses)  // the belief, best first
      if (h.posterior > 0.1) std::cout << ", place " << h.place.value << " with " << h.posterior;
    if (report.pose)
      std::cout << ", at " << report.pose->T_map_robot.translation().head<2>().transpose() << " m";
    std::cout << "\n";
  }
} catch (const std::exception& e) {
  std::cerr << "localise: " << e.what() << "\n";
  return 1;
}
