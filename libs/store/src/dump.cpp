// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/base/text.h"
#include "engram/store/map_file.h"
#include "engram/store/report_json.h"
#include "exact.h"

#include <ostream>
#include <sstream>

namespace engram::store {
namespace {

std::string hex(const void* data, std::size_t size) {
  static const char* const kDigits = "0123456789abcdef";
  std::string out;
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < size; ++i) out.append({kDigits[bytes[i] >> 4], kDigits[bytes[i] & 15]});
  return out;
}

/// Text on one line: line breaks and backslashes are escaped, and what a terminal would obey.
std::string oneLine(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '\n')
      out += "\\n";
    else if (c == '"' || c == '\\')
      (out += '\\') += c;
    else
      out += c;
  }
  return base::forTerminal(out) + '"';
}

template <class Matrix>
std::string numbers(const Matrix& m) {
  std::string out;
  for (Eigen::Index r = 0; r < m.rows(); ++r)
    for (Eigen::Index c = 0; c < m.cols(); ++c) {
      if (!out.empty()) out += ' ';
      out += exact(m(r, c));
    }
  return out;
}

std::string pose(const Eigen::Isometry3d& T) { return numbers(T.matrix().topRows<3>()); }

void dumpMemory(std::ostream& out, const memory::PlaceMemory& m) {
  out << "  memory updates " << m.updates << " next_feature " << m.nextFeatureId << " descriptors "
      << toString(m.features.descriptors.kind()) << ' ' << m.features.descriptors.dim() << '\n';
  for (std::size_t i = 0; i < m.states.size(); ++i) {
    const auto& s = m.states[i];
    const auto& k = m.features.keypoints[i];
    const auto row = m.features.descriptors.row(i);
    out << "  feature " << s.id << (s.stage == memory::Stage::kLongTerm ? " ltm " : " stm ") << exact(s.value)
        << " age " << s.age << " counter " << s.counter << " history "
        << hex(s.history.data(), s.history.size()) << " at " << exact(k.x) << ' ' << exact(k.y) << ' '
        << exact(k.size) << ' ' << exact(k.angle) << ' ' << exact(k.response) << ' '
        << static_cast<int>(k.sign);
    if (!m.features.bearings.empty())
      out << " bearing " << numbers(m.features.bearings[i].transpose().eval());
    if (!m.features.ranges.empty()) out << " range " << exact(m.features.ranges[i]);
    out << " descriptor " << hex(row.data(), row.size()) << '\n';
  }
}

void dumpRedetections(std::ostream& out, const memory::Redetections& seen) {
  if (seen.views == 0) return;
  out << "redetections views " << seen.views << " by_value";
  for (const auto& count : seen.byValue) out << ' ' << count.hits << '/' << count.trials;
  out << " by_age";
  for (const auto& count : seen.byAge) out << ' ' << count.hits << '/' << count.trials;
  out << '\n';
}

void dumpHeader(std::ostream& out, const map::MapHeader& h) {
  out << "engram_map " << kFormatVersion << '\n'
      << "header engram_version " << oneLine(h.engramVersion) << '\n'
      << "header camera " << oneLine(h.camera) << '\n'
      << "header extractor " << oneLine(h.extractor) << '\n'
      << "header descriptors " << toString(h.descriptorKind) << ' ' << h.descriptorDim << '\n'
      << "header memory_model " << oneLine(h.memoryModel) << '\n'
      << "header first_stamp " << exact(h.firstStamp) << '\n';
  std::istringstream parameters(h.parameters);
  for (std::string line; std::getline(parameters, line);)
    out << "header parameter " << base::forTerminal(line) << '\n';
}

}  // namespace

void dump(std::ostream& out, const map::MapHeader& header, const map::MapContent& content,
          const std::vector<types::FrameReport>& records, const std::vector<Drive>& drives) {
  dumpHeader(out, header);
  out << "next " << content.nextPlace << ' ' << content.nextView << ' ' << content.nextEdge << '\n';
  dumpRedetections(out, content.redetections);
  for (const auto& [id, p] : content.places) {
    out << "place " << id.value << " session " << p.session << " stamp " << exact(p.createdStamp) << " image "
        << p.createdIndex << ' ' << oneLine(p.createdLabel) << " pose " << pose(p.T_map_place);
    if (p.T_world_place) out << " surveyed " << pose(*p.T_world_place);
    if (p.standing != map::Standing::kConfirmed) out << " standing " << map::toString(p.standing);
    if (p.matchedStamp) out << " matched " << exact(*p.matchedStamp);
    if (!p.joint.empty()) out << " errors with";
    for (const auto& other : p.joint.with) out << ' ' << other.value;
    if (!p.joint.empty()) out << " covariance " << numbers(p.joint.cov);
    out << '\n';
    dumpMemory(out, p.memory);
  }
  for (const auto& [id, v] : content.views)
    out << "view " << id.value << " place " << v.place.value << " session " << v.session << " stamp "
        << exact(v.stamp) << " image " << v.frameIndex << ' ' << oneLine(v.label) << " jpeg "
        << hex(v.jpeg.data(), v.jpeg.size()) << '\n';
  for (const auto& [id, e] : content.edges) {
    out << "edge " << id.value << ' ' << map::toString(e.type) << ' ' << e.a.value << ' ' << e.b.value
        << " pose " << pose(e.T_a_b.T_a_b) << (e.T_a_b.hasScale ? " scaled" : " unscaled") << " covariance "
        << numbers(e.T_a_b.cov) << " features";
    for (const auto& [a, b] : e.correspondences) out << ' ' << a << ':' << b;
    out << '\n';
  }
  for (const auto& p : content.path)
    out << "path session " << p.session << " stamp " << exact(p.stamp) << " anchor " << p.anchor.value
        << " pose " << pose(p.T_anchor_robot) << '\n';
  for (const auto& d : drives)
    out << "drive " << d.id << " session " << d.session << " first_image " << d.fingerprint << " stamps "
        << exact(d.firstStamp) << ' ' << exact(d.lastStamp) << " first_record " << d.firstRecord << " images "
        << d.images << (d.finished ? " finished" : " cut_off") << '\n';
  for (const auto& r : records) out << "record " << base::forTerminal(toJson(r, false)) << '\n';
}

}  // namespace engram::store
