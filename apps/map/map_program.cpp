// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "map_program.h"

#include "engram/base/atomic_file.h"
#include "engram/base/error.h"
#include "engram/base/text.h"
#include "engram/exporters/exporters.h"
#include "engram/exporters/html_report.h"
#include "engram/store/map_copy.h"
#include "engram/store/map_file.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <iomanip>
#include <ostream>

namespace engram::apps {
namespace {

using Json = nlohmann::ordered_json;
using store::Access;
using store::MapFile;

Json figures(const MapFile& file, const map::TopologicalMap& map) {
  const store::FeatureCounts features = file.featureCounts();
  std::map<std::string, int> edges;
  for (const auto& [id, edge] : map.edges()) ++edges[map::toString(edge.type)];
  double length = 0;
  for (std::size_t i = 1; i < map.path().size(); ++i)
    if (map.path()[i].session == map.path()[i - 1].session)
      length +=
          (map.T_map_robot(map.path()[i]).translation() - map.T_map_robot(map.path()[i - 1]).translation())
              .norm();
  const map::MapHeader& h = file.header();
  Json j = {{"map", file.path()},
            {"engram_version", h.engramVersion},
            {"extractor", h.extractor},
            {"descriptors", store::toString(h.descriptorKind)},
            {"descriptor_dim", h.descriptorDim},
            {"memory_model", h.memoryModel},
            {"camera", h.camera},
            {"first_stamp", h.firstStamp},
            {"places", map.places().size()},
            {"views", file.viewCount()},
            {"edges", map.edges().size()},
            {"edges_by_type", edges},
            {"sessions", map.nextSession()},
            {"components", map.components().size()},
            {"path_points", map.path().size()},
            {"path_length_m", length},
            {"long_term_features", features.longTerm},
            {"short_term_features", features.shortTerm},
            {"records", file.recordCount()},
            {"map_bytes", file.bytes()}};
  j["bytes_per_place"] =
      map.empty() ? 0.0 : static_cast<double>(file.bytes()) / static_cast<double>(map.places().size());
  return j;
}

std::string fixed(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

void line(std::ostream& out, const std::string& name, const std::string& value) {
  out << std::left << std::setw(20) << name << base::forTerminal(value) << '\n';
}

void print(std::ostream& out, const Json& j, const map::MapHeader& h) {
  const auto n = [&](const char* key) { return std::to_string(j.at(key).get<std::uint64_t>()); };
  line(out, "map", j.at("map"));
  line(out, "made by", "Engram " + h.engramVersion);
  line(out, "camera", h.camera.substr(0, h.camera.find('\n')));
  line(out, "features",
       h.extractor + ", " + store::toString(h.descriptorKind) + " descriptors of " +
           std::to_string(h.descriptorDim));
  line(out, "memory model", h.memoryModel);
  line(out, "sessions", n("sessions"));
  line(out, "images", n("records"));
  line(out, "places", n("places") + " in " + n("components") + " connected part(s)");
  line(out, "views", n("views"));
  std::string types;
  for (const auto& [type, count] : j.at("edges_by_type").items()) {
    types += types.empty() ? " (" : ", ";
    types += type + " " + std::to_string(count.get<int>());
  }
  line(out, "edges", n("edges") + types + (types.empty() ? "" : ")"));
  line(out, "path", fixed(j.at("path_length_m"), 1) + " m, " + n("path_points") + " keyframes");
  line(out, "features kept",
       n("long_term_features") + " long-term, " + n("short_term_features") + " short-term");
  line(out, "size",
       fixed(j.at("map_bytes").get<double>() / 1e6, 2) + " MB, " +
           fixed(j.at("bytes_per_place").get<double>() / 1000, 1) + " KB a place");
}

}  // namespace

std::string MapProgram::examples() const {
  return "  engram-map info office.engram                                  what is in it\n"
         "  engram-map info office.engram --json info.json                 the same for programs\n"
         "  engram-map check office.engram                                 is every byte sound?\n"
         "  engram-map copy office.engram backup.engram                    also while it is being written\n"
         "  engram-map recover broken.engram rescued.engram                save what can be read of it\n"
         "  engram-map index old.engram                                    opened fast from now on\n"
         "  engram-map dump office.engram > office.txt                     all content as text, for diff\n"
         "  engram-map config office.engram > office.ini                   the configuration that made it\n"
         "  engram-map export office.engram --format 3dscene --images --out office.3Dscene\n"
         "  engram-map export office.engram --format html --out office.html\n"
         "  engram-map export office.engram --format tum --out path.tum    for evo and the like\n"
         "  engram-map diff monday.engram friday.engram                    what is new, gone, moved\n"
         "  engram-map merge robot1.engram robot2.engram --out both.engram\n"
         "  engram-map reduce office.engram --bytes 20000000 --dry-run     what would have to go\n"
         "  engram-map drives list office.engram\n"
         "  engram-map drives drop office.engram 3\n"
         "  engram-map closures list office.engram\n"
         "  engram-map closures reject office.engram 812\n"
         "  engram-map crop office.engram --region 0,0,25,12\n"
         "  engram-map anonymise office.engram\n"
         "  engram-map train-vocabulary a.engram b.engram --out office.vocabulary\n";
}

void MapProgram::declare(CLI::App& app) {
  app.require_subcommand(1);
  info_ = app.add_subcommand("info", "Print what the map holds");
  check_ = app.add_subcommand("check",
                              "Check all checksums and rules; exit code 1 when the map is damaged, 3 when "
                              "it is sound but was copied without its log");
  dump_ = app.add_subcommand("dump", "Print the whole content as text; equal maps give equal text");
  config_ =
      app.add_subcommand("config", "Print the configuration that the map was made with, or its calibration");
  export_ = app.add_subcommand("export", "Write the map in a format of other programs");
  copyTo_ = app.add_subcommand("copy", "Copy the whole map as it is now, also while a program writes it");
  copy_.declare(*copyTo_);
  recoverTo_ =
      app.add_subcommand("recover",
                         "Make a new map of what can be read of a damaged one; exit code 0: all of it, "
                         "3: some was lost, 1: nothing could be read");
  recover_.declare(*recoverTo_);
  indexOf_ =
      app.add_subcommand("index", "Keep in the map what opening it needs; the end of a drive does it too");
  index_.declare(*indexOf_);
  diff_ = app.add_subcommand("diff", "Compare two maps row by row; exit code 0: equal, 3: they differ");
  diffMaps_.declare(*diff_);
  merge_ = app.add_subcommand(
      "merge", "Make one map of two of one building; exit code 1 when they are kept apart, with the reason");
  mergeMaps_.declare(*merge_);
  keeper_.declare(app);
  train_ =
      app.add_subcommand("train-vocabulary", "Train a vocabulary tree on what the places of maps remember");
  trainVocabulary_.declare(*train_);
  for (CLI::App* command : {info_, check_, dump_, config_, export_}) {
    command->add_option("map", map_, "Map file")->required();
    command->add_flag("-q,--quiet", quiet_, "Print results and errors only");
  }
  config_->add_flag("--camera", camera_, "The calibration instead");
  info_->add_option("--json", json_, "Also write the figures to this file");
  export_
      ->add_option("--format", format_,
                   "3dscene: MRPT's SceneViewer3D; graph: MRPT's pose graph; tum: the path; "
                   "html: report; dot: Graphviz")
      ->required()
      ->check(CLI::IsMember({"3dscene", "graph", "tum", "html", "dot"}));
  export_->add_option("--out", output_, "File to write")->required();
  export_->add_flag("--images", images_, "3dscene: show the thumbnails that the map keeps");
  export_->add_flag("--overwrite", overwrite_, "Replace the file if it exists");
}

int MapProgram::run(std::ostream& out, std::ostream& err) {
  if (info_->parsed()) return info(out, err);
  if (check_->parsed()) return check(out);
  if (dump_->parsed()) return dump(out, err);
  if (config_->parsed()) return config(out);
  if (copyTo_->parsed()) return copy_.run(out, err);
  if (recoverTo_->parsed()) return recover_.run(out, err);
  if (indexOf_->parsed()) return index_.run(out);
  if (train_->parsed()) return trainVocabulary_.run(out, err);
  if (merge_->parsed()) return mergeMaps_.run(out, err);
  if (diff_->parsed()) return diffMaps_.run(out);
  if (const auto code = keeper_.run(out, err)) return *code;
  return exportMap(out);
}

int MapProgram::info(std::ostream& out, std::ostream& err) const {
  printMissingLog(map_, err);
  MapFile file = MapFile::open(map_, Access::kReadOnly);
  base::requireWritable(json_);
  const Json j = figures(file, file.loadGraph());
  if (!quiet_) print(out, j, file.header());
  writeJson(json_, nlohmann::json(j));
  return kOk;
}

int MapProgram::check(std::ostream& out) const {
  const MapFile file = MapFile::open(map_, Access::kReadOnly);
  const auto problems = file.check();
  for (const std::string& problem : problems) out << base::forTerminal(map_ + ": " + problem) << '\n';
  const std::string name = base::forTerminal(map_), missing = store::missingLog(map_);
  if (!missing.empty()) out << name << ": " << base::forTerminal(missing) << '\n';
  if (!problems.empty()) {
    const bool onServer = map_.find("://") != std::string::npos;
    if (!quiet_ && onServer) out << "Bring it back from a backup of the server\n";
    if (!quiet_ && !onServer)
      out << "Save what can be read of it with: engram-map recover " << name << " NEW.engram\n";
    return kError;
  }
  if (!quiet_) out << name << ": sound" << (missing.empty() ? "" : " as far as it goes") << '\n';
  return missing.empty() ? kOk : kPartial;
}

int MapProgram::dump(std::ostream& out, std::ostream& err) const {
  printMissingLog(map_, err);
  MapFile::open(map_, Access::kReadOnly).dump(out);
  return kOk;
}

int MapProgram::config(std::ostream& out) const {
  const map::MapHeader header = MapFile::open(map_, Access::kReadOnly).header();
  std::string text = camera_ ? header.camera : header.parameters;
  if (!text.ends_with('\n')) text += '\n';
  out << text;
  return kOk;
}

int MapProgram::exportMap(std::ostream& out) const {
  requireNew(output_, overwrite_);
  const MapFile file = MapFile::open(map_, Access::kReadOnly);
  const map::TopologicalMap map = file.load();
  if (format_ == "3dscene") {
    exporters::writeScene(output_, map, {.images = images_, .overwrite = overwrite_});
  } else if (format_ == "graph") {
    exporters::writeGraph(output_, map, overwrite_);
  } else if (format_ == "tum") {
    exporters::writeTum(output_, map, overwrite_);
  } else if (format_ == "dot") {
    exporters::writeDot(output_, map, overwrite_);
  } else {
    const auto records = file.records();
    const std::string name = std::filesystem::path(map_).filename().string();
    base::writeText(output_,
                    exporters::toHtml({.title = "Engram map " + name,
                                       .header = &file.header(),
                                       .map = &map,
                                       .records = records,
                                       .figures = {{"Size of the file [MB]",
                                                    fixed(static_cast<double>(file.bytes()) / 1e6, 2)}}}),
                    overwrite_);
  }
  if (!quiet_) out << base::forTerminal(output_) << ": written\n";
  return kOk;
}

}  // namespace engram::apps
