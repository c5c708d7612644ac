// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace engram::types {

/// An interest point. The centre of the top left pixel is (0, 0).
struct Keypoint {
  float x = 0, y = 0;    ///< [px]
  float size = 0;        ///< diameter of the described region [px]
  float angle = 0;       ///< orientation in the image, x to y [rad]; 0 for upright features
  float response = 0;    ///< detector strength; for SURF the normalised determinant of the Hessian
  std::int8_t sign = 0;  ///< sign of the Laplacian (+1, -1), 0 where the detector has none
};

/// How a descriptor is stored and compared.
enum class DescriptorKind : std::uint8_t {
  kFloat,  ///< `dim` floats of unit L2 norm; distance L2
  kInt8,   ///< `dim` bytes: a float component c is stored as round(c * kInt8Scale), saturated; distance L2 of
           ///< c
  kBinary,  ///< `dim` bits, 8 to a byte, padded with zero bits to a multiple of 8 bytes; distance Hamming /
            ///< dim
};

/// Components of 0.5 and more saturate; almost none of a unit 64-D or 128-D descriptor are so large.
inline constexpr float kInt8Scale = 254.0f;

/// N descriptors in one contiguous block, row after row.
class Descriptors {
 public:
  Descriptors() = default;
  Descriptors(DescriptorKind kind, int dim) : kind_(kind), dim_(dim) {}

  DescriptorKind kind() const { return kind_; }
  int dim() const { return dim_; }  ///< components (kFloat, kInt8) or bits (kBinary)
  std::size_t rowBytes() const;
  std::size_t size() const { return rowBytes() == 0 ? 0 : bytes_.size() / rowBytes(); }
  bool empty() const { return bytes_.empty(); }
  bool sameLayout(const Descriptors& o) const { return kind_ == o.kind_ && dim_ == o.dim_; }

  std::span<const std::byte> row(std::size_t i) const { return {bytes_.data() + i * rowBytes(), rowBytes()}; }
  const float* floats(std::size_t i) const;         ///< row i of kFloat
  const std::int8_t* int8(std::size_t i) const;     ///< row i of kInt8
  const std::uint64_t* words(std::size_t i) const;  ///< row i of kBinary, rowBytes()/8 words

  void reserve(std::size_t n) { bytes_.reserve(n * rowBytes()); }
  void resize(std::size_t n) { bytes_.resize(n * rowBytes()); }
  std::byte* mutableRow(std::size_t i) { return bytes_.data() + i * rowBytes(); }
  void append(std::span<const std::byte> row) { bytes_.insert(bytes_.end(), row.begin(), row.end()); }
  const std::vector<std::byte>& bytes() const { return bytes_; }

  bool operator==(const Descriptors&) const = default;

 private:
  DescriptorKind kind_ = DescriptorKind::kFloat;
  int dim_ = 0;
  std::vector<std::byte> bytes_;  // allocated with new: aligned to 16 bytes; rows are multiples of 4 bytes
};

/// The kInt8 form of kFloat descriptors; others are returned as they are.
Descriptors quantised(const Descriptors& descriptors);

/// N features of one image, or N remembered ones: parallel arrays of equal length.
struct Features {
  std::vector<Keypoint> keypoints;
  Descriptors descriptors;
  std::vector<Eigen::Vector3f>
      bearings;                 ///< unit rays in the camera frame; empty when no camera model is known
  std::vector<float> ranges{};  ///< distance of the point from the camera [m], 0 where unknown; empty where
                                ///< all are

  std::size_t size() const { return keypoints.size(); }
  bool empty() const { return keypoints.empty(); }
  /// The features with these indices, in this order.
  Features subset(std::span<const int> indices) const;
  /// Appends feature i of `other`, which must have the same descriptor layout.
  void append(const Features& other, std::size_t i);
};

}  // namespace engram::types
