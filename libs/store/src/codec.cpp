// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "codec.h"

#include <limits>
#include <type_traits>

namespace engram::store {
namespace {

constexpr std::uint8_t kVersion = 1;       // of every kind of row
constexpr std::uint8_t kStateVersion = 3;  // but of these
constexpr std::uint8_t kStateWithRedetections = 2;
constexpr std::uint8_t kPlaceWithStanding = 2, kPlaceVersion = 3;
constexpr std::uint8_t kFeaturesVersion = 2;  // rows with features; 1 without ranges

constexpr std::uint8_t kHasBearings = 1, kHasRanges = 2;  // of features

void putPose(BlobWriter& out, const Eigen::Isometry3d& T) {
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) out.put(T.matrix()(r, c));
}

Eigen::Isometry3d getPose(BlobReader& in) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 4; ++c) T.matrix()(r, c) = in.get<double>();
  return T;
}

/// One field of all items after another, first the lowest byte of all, last the highest: like bytes stand
/// together, which is what compression needs.
template <class Items, class Get>
void putColumn(BlobWriter& out, const Items& items, Get&& get) {
  using T = std::invoke_result_t<Get, decltype(*items.begin())>;
  std::vector<std::uint8_t> planes(items.size() * sizeof(T));
  for (std::size_t i = 0; i < items.size(); ++i) {
    const T value = get(items[i]);
    std::uint8_t bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (std::size_t b = 0; b < sizeof(T); ++b) planes[b * items.size() + i] = bytes[b];
  }
  out.raw(planes.data(), planes.size());
}

template <class T, class Items, class Set>
void getColumn(BlobReader& in, Items& items, Set&& set) {
  in.require(items.size() * sizeof(T));
  std::vector<std::uint8_t> planes(items.size() * sizeof(T));
  in.raw(planes.data(), planes.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    std::uint8_t bytes[sizeof(T)];
    for (std::size_t b = 0; b < sizeof(T); ++b) bytes[b] = planes[b * items.size() + i];
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    set(items[i], value);
  }
}

void putFeatures(BlobWriter& out, const types::Features& f) {
  using types::Keypoint;
  putColumn(out, f.keypoints, [](const Keypoint& k) { return k.x; });
  putColumn(out, f.keypoints, [](const Keypoint& k) { return k.y; });
  putColumn(out, f.keypoints, [](const Keypoint& k) { return k.size; });
  putColumn(out, f.keypoints, [](const Keypoint& k) { return k.angle; });
  putColumn(out, f.keypoints, [](const Keypoint& k) { return k.response; });
  putColumn(out, f.keypoints, [](const Keypoint& k) { return k.sign; });
  out.put(static_cast<std::uint8_t>(f.descriptors.kind()));
  out.varint(static_cast<std::uint64_t>(f.descriptors.dim()));
  out.raw(f.descriptors.bytes().data(), f.descriptors.bytes().size());
  out.put(static_cast<std::uint8_t>((f.bearings.empty() ? 0 : kHasBearings) |
                                    (f.ranges.empty() ? 0 : kHasRanges)));
  for (int axis = 0; axis < 3; ++axis)
    putColumn(out, f.bearings, [axis](const Eigen::Vector3f& b) { return b[axis]; });
  putColumn(out, f.ranges, [](float range) { return range; });
}

std::uint8_t featuresVersion(const types::Features& f) {
  return f.ranges.empty() ? kVersion : kFeaturesVersion;
}

types::Features getFeatures(BlobReader& in, std::size_t n) {
  using types::Keypoint;
  types::Features f;
  f.keypoints.resize(n);
  getColumn<float>(in, f.keypoints, [](Keypoint& k, float v) { k.x = v; });
  getColumn<float>(in, f.keypoints, [](Keypoint& k, float v) { k.y = v; });
  getColumn<float>(in, f.keypoints, [](Keypoint& k, float v) { k.size = v; });
  getColumn<float>(in, f.keypoints, [](Keypoint& k, float v) { k.angle = v; });
  getColumn<float>(in, f.keypoints, [](Keypoint& k, float v) { k.response = v; });
  getColumn<std::int8_t>(in, f.keypoints, [](Keypoint& k, std::int8_t v) { k.sign = v; });
  const auto kind = in.get<std::uint8_t>();
  const auto dim = in.varint();
  if (kind > static_cast<std::uint8_t>(types::DescriptorKind::kBinary) || dim > map::kMostDescriptorDim)
    throw base::Error("its descriptors are of an unknown kind");
  if (n > 0 && dim == 0) throw base::Error("its descriptors have no components");
  f.descriptors = types::Descriptors(static_cast<types::DescriptorKind>(kind), static_cast<int>(dim));
  in.require(n * f.descriptors.rowBytes());
  f.descriptors.resize(n);
  for (std::size_t i = 0; i < n; ++i) in.raw(f.descriptors.mutableRow(i), f.descriptors.rowBytes());
  const auto has = in.get<std::uint8_t>();
  if (has > (kHasBearings | kHasRanges)) throw base::Error("its features have parts of an unknown kind");
  if (has & kHasBearings) f.bearings.resize(n);
  for (int axis = 0; axis < 3; ++axis)
    getColumn<float>(in, f.bearings, [axis](Eigen::Vector3f& b, float v) { b[axis] = v; });
  if (has & kHasRanges) f.ranges.resize(n);
  getColumn<float>(in, f.ranges, [](float& range, float v) { range = v; });
  return f;
}

void putRedetections(BlobWriter& out, const memory::Redetections& seen) {
  out.varint(seen.views);
  const auto put = [&](const auto& counts) {
    out.varint(counts.size());
    for (const auto& count : counts) {
      out.varint(count.trials);
      out.varint(count.hits);
    }
  };
  put(seen.byValue);
  put(seen.byAge);
}

memory::Redetections getRedetections(BlobReader& in) {
  memory::Redetections seen;
  seen.views = in.varint();
  const auto get = [&](auto& counts) {
    if (in.varint() != counts.size()) throw base::Error("it counts re-detections in another way");
    for (auto& count : counts) {
      count.trials = in.varint();
      count.hits = in.varint();
    }
  };
  get(seen.byValue);
  get(seen.byAge);
  return seen;
}

/// More rows than numbers were given out, or no number left.
void requirePossible(const MapState& s) {
  if (s.places > s.nextPlace || s.views > s.nextView || s.edges > s.nextEdge)
    throw base::Error("it counts more rows than numbers were given out");
  for (const std::uint64_t next :
       {std::uint64_t{s.nextPlace}, std::uint64_t{s.nextView}, std::uint64_t{s.nextEdge}, s.path, s.records})
    if (next > map::kMostIds) throw base::Error("it leaves no numbers for new rows");
}

/// The row holds all of them together: each may be as long as the row, but not every one.
void getHistories(BlobReader& in, std::vector<memory::FeatureState>& states) {
  std::vector<std::size_t> lengths(states.size());
  std::size_t sum = 0;
  for (std::size_t& length : lengths) sum += length = in.count(1);
  in.require(sum);
  for (std::size_t i = 0; i < states.size(); ++i) {
    states[i].history.resize(lengths[i]);
    in.raw(states[i].history.data(), lengths[i]);
  }
}

}  // namespace

Blob encode(const MapState& s) {
  const bool learnt = s.redetections.views > 0, forgot = s.firstRecord > 0;
  BlobWriter out(RowKind::kState, forgot ? kStateVersion : learnt ? kStateWithRedetections : kVersion);
  for (const std::uint32_t v : {s.nextPlace, s.nextView, s.nextEdge}) out.put(v);
  for (const std::uint64_t v : {s.commits, s.places, s.views, s.edges, s.path, s.records}) out.put(v);
  if (learnt || forgot) putRedetections(out, s.redetections);
  if (forgot) out.put(s.firstRecord);
  return std::move(out).seal(0);
}

MapState decodeState(std::span<const std::uint8_t> row) {
  BlobReader in(row, RowKind::kState, kStateVersion, 0);
  MapState s;
  for (std::uint32_t* v : {&s.nextPlace, &s.nextView, &s.nextEdge}) *v = in.get<std::uint32_t>();
  for (std::uint64_t* v : {&s.commits, &s.places, &s.views, &s.edges, &s.path, &s.records})
    *v = in.get<std::uint64_t>();
  if (in.version() >= kStateWithRedetections) s.redetections = getRedetections(in);
  if (in.version() >= kStateVersion) s.firstRecord = in.get<std::uint64_t>();
  in.requireEnd();
  requirePossible(s);
  return s;
}

namespace {

std::uint8_t versionFor(const map::Place& place) {
  if (!place.joint.empty()) return kPlaceVersion;
  const bool judged = place.standing != map::Standing::kConfirmed || place.matchedStamp;
  return judged ? kPlaceWithStanding : kVersion;
}

void putJoint(BlobWriter& out, const map::JointErrors& joint) {
  out.put(static_cast<std::uint8_t>(joint.cov.rows()));
  out.varint(joint.with.size());
  for (const map::PlaceId id : joint.with) out.put(id.value);
  out.raw(joint.cov.data(), sizeof(double) * static_cast<std::size_t>(joint.cov.size()));
}

map::JointErrors getJoint(BlobReader& in) {
  map::JointErrors joint;
  const auto rows = in.get<std::uint8_t>();
  if (rows != 3 && rows != 6) throw base::Error("its covariance is of an unknown size");
  joint.with.resize(in.count(4 + sizeof(double) * rows * rows));
  for (map::PlaceId& id : joint.with) id = map::PlaceId(in.get<std::uint32_t>());
  joint.cov.resize(rows, rows * static_cast<Eigen::Index>(joint.with.size()));
  in.raw(joint.cov.data(), sizeof(double) * static_cast<std::size_t>(joint.cov.size()));
  return joint;
}

}  // namespace

Blob encode(const map::Place& place) {
  const std::uint8_t version = versionFor(place);
  BlobWriter out(RowKind::kPlace, version);
  putPose(out, place.T_map_place);
  out.put(place.createdStamp);
  out.varint(place.createdIndex);
  out.text(place.createdLabel);
  out.put(static_cast<std::int32_t>(place.session));
  out.put(static_cast<std::uint8_t>(place.T_world_place ? 1 : 0));
  if (place.T_world_place) putPose(out, *place.T_world_place);
  if (version >= kPlaceWithStanding) {
    out.put(static_cast<std::uint8_t>(place.standing));
    out.put(static_cast<std::uint8_t>(place.matchedStamp ? 1 : 0));
    if (place.matchedStamp) out.put(*place.matchedStamp);
  }
  if (version >= kPlaceVersion) putJoint(out, place.joint);
  return std::move(out).seal(place.id.value);
}

map::Place decodePlace(std::span<const std::uint8_t> row, std::uint64_t id) {
  BlobReader in(row, RowKind::kPlace, kPlaceVersion, id);
  map::Place place;
  place.id = map::PlaceId(static_cast<std::uint32_t>(id));
  place.T_map_place = getPose(in);
  place.createdStamp = in.get<double>();
  place.createdIndex = in.varint();
  place.createdLabel = in.text();
  place.session = in.get<std::int32_t>();
  if (in.flag()) place.T_world_place = getPose(in);
  if (in.version() >= kPlaceWithStanding) {
    const auto standing = in.get<std::uint8_t>();
    if (standing > static_cast<std::uint8_t>(map::Standing::kProbation))
      throw base::Error("it is of an unknown standing");
    place.standing = static_cast<map::Standing>(standing);
    if (in.flag()) place.matchedStamp = in.get<double>();
  }
  if (in.version() >= kPlaceVersion) place.joint = getJoint(in);
  in.requireEnd();
  return place;
}

Blob encodeMemory(map::PlaceId id, const memory::PlaceMemory& m) {
  using memory::FeatureState;
  BlobWriter out(RowKind::kMemory, featuresVersion(m.features));
  out.varint(m.states.size());
  out.put(m.updates);
  out.put(m.nextFeatureId);
  putColumn(out, m.states, [](const FeatureState& s) { return s.id; });
  putColumn(out, m.states, [](const FeatureState& s) { return s.value; });
  putColumn(out, m.states, [](const FeatureState& s) { return s.age; });
  putColumn(out, m.states, [](const FeatureState& s) { return static_cast<std::uint8_t>(s.stage); });
  for (const FeatureState& s : m.states) out.varint(s.counter);
  for (const FeatureState& s : m.states) out.varint(s.history.size());
  for (const FeatureState& s : m.states) out.raw(s.history.data(), s.history.size());
  putFeatures(out, m.features);
  out.compress();
  return std::move(out).seal(id.value);
}

memory::PlaceMemory decodeMemory(std::span<const std::uint8_t> row, std::uint64_t id) {
  using memory::FeatureState;
  BlobReader in(row, RowKind::kMemory, kFeaturesVersion, id);
  in.decompress();
  memory::PlaceMemory m;
  const std::size_t n =
      in.count(32);  // a feature takes more than that: no huge allocation for a false number
  m.updates = in.get<std::uint32_t>();
  m.nextFeatureId = in.get<std::uint32_t>();
  m.states.resize(n);
  getColumn<std::uint32_t>(in, m.states, [](FeatureState& s, std::uint32_t v) { s.id = v; });
  getColumn<float>(in, m.states, [](FeatureState& s, float v) { s.value = v; });
  getColumn<std::uint16_t>(in, m.states, [](FeatureState& s, std::uint16_t v) { s.age = v; });
  getColumn<std::uint8_t>(in, m.states, [](FeatureState& s, std::uint8_t v) {
    if (v > static_cast<std::uint8_t>(memory::Stage::kLongTerm))
      throw base::Error("a feature is in an unknown stage");
    s.stage = static_cast<memory::Stage>(v);
  });
  for (FeatureState& s : m.states)
    s.counter = static_cast<std::uint16_t>(in.varint(std::numeric_limits<std::uint16_t>::max()));
  getHistories(in, m.states);
  m.features = getFeatures(in, n);
  in.requireEnd();
  return m;
}

Blob encodeFeatures(const types::Features& features, std::uint64_t row) {
  BlobWriter out(RowKind::kFeatures, featuresVersion(features));
  out.varint(features.size());
  putFeatures(out, features);
  out.compress();
  return std::move(out).seal(row);
}

types::Features decodeFeatures(std::span<const std::uint8_t> row, std::uint64_t id) {
  BlobReader in(row, RowKind::kFeatures, kFeaturesVersion, id);
  in.decompress();
  types::Features features = getFeatures(in, in.count(21));  // a keypoint takes so many bytes
  in.requireEnd();
  return features;
}

Blob encode(const map::View& view) {
  BlobWriter out(RowKind::kView, kVersion);
  out.put(view.place.value);
  out.put(view.stamp);
  out.varint(view.frameIndex);
  out.text(view.label);
  out.put(static_cast<std::int32_t>(view.session));
  out.varint(view.jpeg.size());
  out.raw(view.jpeg.data(), view.jpeg.size());
  return std::move(out).seal(view.id.value);
}

map::View decodeView(std::span<const std::uint8_t> row, std::uint64_t id) {
  BlobReader in(row, RowKind::kView, kVersion, id);
  map::View view;
  view.id = map::ViewId(static_cast<std::uint32_t>(id));
  view.place = map::PlaceId(in.get<std::uint32_t>());
  view.stamp = in.get<double>();
  view.frameIndex = in.varint();
  view.label = in.text();
  view.session = in.get<std::int32_t>();
  view.jpeg.resize(in.count(1));
  in.raw(view.jpeg.data(), view.jpeg.size());
  in.requireEnd();
  return view;
}

Blob encode(const map::Edge& edge) {
  BlobWriter out(RowKind::kEdge, kVersion);
  out.put(static_cast<std::uint8_t>(edge.type));
  out.put(edge.a.value);
  out.put(edge.b.value);
  putPose(out, edge.T_a_b.T_a_b);
  out.raw(edge.T_a_b.cov.data(), sizeof(double) * 36);
  out.put(static_cast<std::uint8_t>(edge.T_a_b.hasScale ? 1 : 0));
  out.varint(edge.correspondences.size());
  for (const auto& [a, b] : edge.correspondences) {
    out.varint(a);
    out.varint(b);
  }
  return std::move(out).seal(edge.id.value);
}

map::Edge decodeEdge(std::span<const std::uint8_t> row, std::uint64_t id) {
  BlobReader in(row, RowKind::kEdge, kVersion, id);
  map::Edge edge;
  edge.id = map::EdgeId(static_cast<std::uint32_t>(id));
  const auto type = in.get<std::uint8_t>();
  if (type > static_cast<std::uint8_t>(map::EdgeType::kDeadReckoning))
    throw base::Error("it is of an unknown type");
  edge.type = static_cast<map::EdgeType>(type);
  edge.a = map::PlaceId(in.get<std::uint32_t>());
  edge.b = map::PlaceId(in.get<std::uint32_t>());
  edge.T_a_b.T_a_b = getPose(in);
  in.raw(edge.T_a_b.cov.data(), sizeof(double) * 36);
  edge.T_a_b.hasScale = in.flag();
  edge.correspondences.resize(in.count(2));
  for (auto& [a, b] : edge.correspondences) {
    a = static_cast<std::uint32_t>(in.varint(map::PlaceId::kInvalid));
    b = static_cast<std::uint32_t>(in.varint(map::PlaceId::kInvalid));
  }
  in.requireEnd();
  return edge;
}

Blob encode(const map::PathPoint& point, std::uint64_t row) {
  BlobWriter out(RowKind::kPath, kVersion);
  out.put(static_cast<std::int32_t>(point.session));
  out.put(point.stamp);
  out.put(point.anchor.value);
  putPose(out, point.T_anchor_robot);
  return std::move(out).seal(row);
}

map::PathPoint decodePathPoint(std::span<const std::uint8_t> row, std::uint64_t index) {
  BlobReader in(row, RowKind::kPath, kVersion, index);
  map::PathPoint point;
  point.session = in.get<std::int32_t>();
  point.stamp = in.get<double>();
  point.anchor = map::PlaceId(in.get<std::uint32_t>());
  point.T_anchor_robot = getPose(in);
  in.requireEnd();
  return point;
}

Blob encode(const Drive& drive) {
  BlobWriter out(RowKind::kDrive, kVersion);
  out.put(static_cast<std::int32_t>(drive.session));
  out.text(drive.source);
  out.put(drive.fingerprint);
  out.put(drive.firstStamp);
  out.put(drive.lastStamp);
  out.put(drive.firstRecord);
  out.put(drive.images);
  out.put(static_cast<std::uint8_t>(drive.finished ? 1 : 0));
  return std::move(out).seal(drive.id);
}

Drive decodeDrive(std::span<const std::uint8_t> row, std::uint64_t id) {
  BlobReader in(row, RowKind::kDrive, kVersion, id);
  Drive drive;
  drive.id = static_cast<std::uint32_t>(id);
  drive.session = in.get<std::int32_t>();
  drive.source = in.text();
  drive.fingerprint = in.get<std::uint32_t>();
  drive.firstStamp = in.get<double>();
  drive.lastStamp = in.get<double>();
  drive.firstRecord = in.get<std::uint64_t>();
  drive.images = in.get<std::uint64_t>();
  drive.finished = in.flag();
  in.requireEnd();
  return drive;
}

}  // namespace engram::store
