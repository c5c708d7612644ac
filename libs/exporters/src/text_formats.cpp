// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/atomic_file.h"
#include "engram/exporters/exporters.h"
#include "engram/map/graph.h"
#include "engram/posegraph/mrpt_graph.h"

#include <iomanip>
#include <sstream>

namespace engram::exporters {

void writeGraph(const std::string& path, const map::TopologicalMap& map, bool overwrite) {
  std::ostringstream out;
  out << std::setprecision(17);  // MRPT's own saveToTextFile() keeps six digits
  posegraph::toMrpt(map::toGraph(map)).writeAsText(out);
  base::writeText(path, out.str(), overwrite);
}

void writeTum(const std::string& path, const map::TopologicalMap& map, bool overwrite) {
  std::ostringstream out;
  out << "# stamp [s] x y z [m] qx qy qz qw\n" << std::fixed;
  for (const map::PathPoint& point : map.path()) {
    const Eigen::Isometry3d T = map.T_map_robot(point);
    const Eigen::Quaterniond q(T.linear());
    out << std::setprecision(6) << point.stamp << std::setprecision(9);
    for (const double v :
         {T.translation().x(), T.translation().y(), T.translation().z(), q.x(), q.y(), q.z(), q.w()})
      out << ' ' << v;
    out << '\n';
  }
  base::writeText(path, out.str(), overwrite);
}

void writeDot(const std::string& path, const map::TopologicalMap& map, bool overwrite) {
  constexpr double kPointsPerMetre = 36;
  std::ostringstream out;
  out << "graph engram {\n  node [shape=circle, width=0.3, fixedsize=true, fontsize=8];\n"
      << std::setprecision(9);
  for (const auto& [id, place] : map.places()) {
    const Eigen::Vector3d t = place.T_map_place.translation() * kPointsPerMetre;
    out << "  " << id.value << " [pos=\"" << t.x() << ',' << t.y() << "\"];\n";
  }
  for (const auto& [id, edge] : map.edges())
    out << "  " << edge.a.value << " -- " << edge.b.value << " [class=" << map::toString(edge.type)
        << (edge.type == map::EdgeType::kOdometry ? "" : ", penwidth=2")
        << (!map::isPassage(edge.type) ? ", style=dashed" : "") << "];\n";
  out << "}\n";
  base::writeText(path, out.str(), overwrite);
}

}  // namespace engram::exporters
