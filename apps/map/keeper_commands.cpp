// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "keeper_commands.h"

#include "engram/apps/program.h"
#include "engram/base/text.h"
#include "engram/keeper/closures.h"
#include "engram/keeper/edits.h"
#include "engram/store/map_file.h"

#include <cstdio>
#include <iomanip>
#include <ostream>
#include <sstream>

namespace engram::apps {
namespace {

keeper::Region regionOf(const std::string& text) {
  keeper::Region r;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf%c", &r.x0, &r.y0, &r.x1, &r.y1, &rest) != 4 ||
      !(r.x0 < r.x1) || !(r.y0 < r.y1))
    throw UsageError("--region needs X0,Y0,X1,Y1 in metres of the map frame, X0 < X1 and Y0 < Y1, not '" +
                     text + "'");
  return r;
}

std::string counted(std::size_t n, const std::string& thing) {
  return std::to_string(n) + ' ' + thing + (n == 1 ? "" : "s");
}

}  // namespace

CLI::App* KeeperCommands::addEdit(CLI::App& parent, const std::string& name, const std::string& description) {
  CLI::App* command = parent.add_subcommand(name, description);
  edit_.declare(*command);
  return command;
}

void KeeperCommands::declare(CLI::App& app) {
  reduce_ = addEdit(app, "reduce", "Make a map smaller: views that others say the same as go, oldest first");
  auto* bytes =
      reduce_->add_option("--bytes", bytes_, "To at most so many bytes of rows")->check(CLI::PositiveNumber);
  reduce_->add_option("--views", views_, "To at most so many places (in a map of views, each is one)")
      ->check(CLI::PositiveNumber)
      ->excludes(bytes);
  relax_ = addEdit(app, "relax", "Examine all closures again and move every place to where the edges say");
  crop_ = addEdit(app, "crop", "Keep a region of the map alone");
  crop_->add_option("--region", region_, "X0,Y0,X1,Y1 in the map frame [m]")->required();
  anonymise_ =
      addEdit(app, "anonymise", "Take away thumbnails, names of files, and features that were seen once");
  anonymise_->add_flag("--keep-names", keepNames_, "Names of images and rawlogs stay");
  declareDrives(app);
  declareClosures(app);
}

void KeeperCommands::declareDrives(CLI::App& app) {
  CLI::App* drives = app.add_subcommand("drives", "The drives that made a map: list them, drop one");
  drives->require_subcommand(1);
  listDrives_ = drives->add_subcommand("list", "Print the drives of a map");
  listDrives_->add_option("map", listed_, "Map file")->required();
  dropDrive_ =
      addEdit(*drives, "drop", "Take one drive out: its path, records, and places that no other has been at");
  dropDrive_->add_option("drive", drive_, "Its number, as drives list prints it")->required();
}

void KeeperCommands::declareClosures(CLI::App& app) {
  CLI::App* closures = app.add_subcommand("closures", "Loop closures and recognitions: list, reject, add");
  closures->require_subcommand(1);
  listClosures_ =
      closures->add_subcommand("list", "Print each, with how well it fits the map and still matches");
  listClosures_->add_option("map", listed_, "Map file")->required();
  rejectClosures_ =
      addEdit(*closures, "reject", "Take closures out; the map remembers that these places are two");
  rejectClosures_->add_option("edges", edges_, "Numbers of their edges")->required();
  addClosure_ =
      addEdit(*closures, "add", "Join two places that show the same ground, if memory and graph agree");
  addClosure_->add_option("place_a", placeA_, "Number of a place")->required();
  addClosure_->add_option("place_b", placeB_, "Number of another one")->required();
}

std::optional<int> KeeperCommands::run(std::ostream& out, std::ostream& err) {
  if (reduce_->parsed()) return reduce(out, err);
  if (relax_->parsed()) return relax(out, err);
  if (crop_->parsed()) return crop(out, err);
  if (anonymise_->parsed()) return anonymise(out, err);
  if (listDrives_->parsed()) return listDrives(out);
  if (dropDrive_->parsed()) return dropDrive(out, err);
  if (listClosures_->parsed()) return listClosures(out);
  if (rejectClosures_->parsed()) return rejectClosures(out, err);
  if (addClosure_->parsed()) return addClosure(out, err);
  return std::nullopt;
}

int KeeperCommands::reduce(std::ostream& out, std::ostream& err) {
  if (bytes_ == 0 && views_ == 0) throw UsageError("reduce needs --bytes N or --views N");
  keeper::Target target;
  if (bytes_ > 0) target.bytes = bytes_;
  if (views_ > 0) target.views = views_;
  bool reached = true;
  const int code = edit_.run(out, err, [&](store::WholeMap& map, std::ostream& say) {
    const auto configuration = keeper::configurationOf(map.header, edit_.map());
    const keeper::Reduced done = keeper::reduce(map, target, configuration.params);
    reached = done.reached;
    say << counted(done.removed, "place") << " removed, " << map.content.places.size() << " left in "
        << done.bytes << " bytes of rows; neighbourhoods of " << done.distance << " m keep "
        << done.perNeighbourhood << '\n';
    return done.removed > 0;
  });
  if (!reached) err << "engram-map: the map cannot be made that small: path and records of drives stay\n";
  return reached ? code : kPartial;
}

int KeeperCommands::relax(std::ostream& out, std::ostream& err) {
  return edit_.run(out, err, [&](store::WholeMap& map, std::ostream& say) {
    const keeper::Relaxed done = keeper::relax(map, keeper::configurationOf(map.header, edit_.map()).params);
    say << "places moved by " << done.moved << " m on average, " << done.movedMost << " m at most; "
        << counted(done.dropped, "closure") << " denied\n";
    return done.movedMost > 0 || done.dropped > 0;
  });
}

int KeeperCommands::crop(std::ostream& out, std::ostream& err) {
  const keeper::Region region = regionOf(region_);
  return edit_.run(out, err, [&](store::WholeMap& map, std::ostream& say) {
    const keeper::Cropped done = keeper::crop(map, region);
    say << counted(done.places, "place") << ", " << counted(done.pathPoints, "path point")
        << " and records of " << counted(done.records, "image") << " removed, " << map.content.places.size()
        << " places left\n";
    return done.places + done.pathPoints + done.records > 0;
  });
}

int KeeperCommands::anonymise(std::ostream& out, std::ostream& err) {
  return edit_.run(out, err, [&](store::WholeMap& map, std::ostream& say) {
    const keeper::Anonymised done = keeper::anonymise(map, keepNames_);
    say << counted(done.pictures, "thumbnail") << ", " << counted(done.names, "name") << " and "
        << counted(done.features, "feature") << " that were seen once removed\n";
    const bool looks = map.header.parameters.find("\nchannel = hog") != std::string::npos ||
                       map.header.parameters.find("\nchannel = thumbnail") != std::string::npos;
    if (looks && done.pictures > 0)
      say << "its configuration compares whole images by thumbnails: without them features alone are "
             "evidence\n";
    return done.pictures + done.names + done.features > 0;
  });
}

int KeeperCommands::listDrives(std::ostream& out) const {
  const auto file = store::MapFile::open(listed_, store::Access::kReadOnly);
  const auto drives = file.drives();
  if (drives.empty()) out << "the map does not know its drives\n";
  for (const store::Drive& d : drives) {
    out << base::forTerminal(store::describe(d));
    if (d.session >= 0) out << ", session " << d.session;
    out << ", first record " << d.firstRecord << std::fixed << std::setprecision(3) << ", stamps "
        << d.firstStamp << " to " << d.lastStamp << (d.finished ? "" : ", cut off") << '\n';
  }
  return kOk;
}

int KeeperCommands::dropDrive(std::ostream& out, std::ostream& err) {
  return edit_.run(out, err, [&](store::WholeMap& map, std::ostream& say) {
    const keeper::DroppedDrive done = keeper::dropDrive(map, drive_);
    say << counted(done.places, "place") << ", " << counted(done.views, "view") << ", "
        << counted(done.pathPoints, "path point") << " and records of " << counted(done.records, "image")
        << " removed; " << counted(done.kept, "place") << " of it stay, where other drives have been\n";
    return true;
  });
}

int KeeperCommands::listClosures(std::ostream& out) const {
  const auto file = store::MapFile::open(listed_, store::Access::kReadOnly);
  const store::WholeMap map = file.whole();
  out << "edge  type         places         gap [m]  gap [deg]  chi2      matches now\n";
  for (const keeper::Closure& c : keeper::closures(map, keeper::configurationOf(map.header, listed_))) {
    char line[160];
    std::snprintf(line, sizeof line, "%-5u %-12s %5u %5u   %9.3f  %9.2f  %-8.2f  %d\n", c.id.value,
                  map::toString(c.type), c.a.value, c.b.value, c.distance, c.angle * 180 / M_PI, c.chi2,
                  c.matches);
    out << line;
  }
  for (const auto& [a, b] : keeper::rejectionsOf(map.notes))
    out << "rejected     places " << a.value << ' ' << b.value << '\n';
  return kOk;
}

int KeeperCommands::rejectClosures(std::ostream& out, std::ostream& err) {
  return edit_.run(out, err, [&](store::WholeMap& map, std::ostream& say) {
    std::vector<map::EdgeId> ids;
    for (const std::uint32_t edge : edges_) ids.emplace_back(edge);
    const std::size_t before = map.content.edges.size();
    keeper::reject(map, ids, keeper::configurationOf(map.header, edit_.map()).params);
    say << counted(before - map.content.edges.size(), "closure") << " taken out; their places stay apart\n";
    return true;
  });
}

int KeeperCommands::addClosure(std::ostream& out, std::ostream& err) {
  std::string refusal;
  const int code = edit_.run(out, err, [&](store::WholeMap& map, std::ostream& say) {
    const keeper::Added added = keeper::addClosure(map, map::PlaceId(placeA_), map::PlaceId(placeB_),
                                                   keeper::configurationOf(map.header, edit_.map()));
    refusal = added.reason;
    if (added.accepted)
      say << "edge " << added.edge.value << " joins them, by " << added.matches << " features\n";
    return added.accepted;
  });
  if (refusal.empty()) return code;
  err << "engram-map: not joined: " << refusal << '\n';
  return kPartial;
}

}  // namespace engram::apps
