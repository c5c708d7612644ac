// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/kmeans_dictionary.h"

#include "engram/base/rng.h"

#include <opencv2/core.hpp>

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>

namespace engram::vocabulary {
namespace {

using types::DescriptorKind;

void requireFloats(const types::Descriptors& d) {
  if (d.kind() == DescriptorKind::kBinary)
    throw base::Error(
        "[bow] the k-means dictionary has no mean of binary descriptors: choose an extractor with float "
        "descriptors, surf or sift");
}

void copyRow(const types::Descriptors& d, std::size_t i, float* out) {
  if (d.kind() == DescriptorKind::kFloat)
    std::copy_n(d.floats(i), d.dim(), out);
  else
    std::transform(d.int8(i), d.int8(i) + d.dim(), out,
                   [](std::int8_t c) { return static_cast<float>(c) / types::kInt8Scale; });
}

/// Image and row of every descriptor.
using Pool = std::vector<std::pair<const types::Descriptors*, std::size_t>>;

Pool gather(std::span<const types::Descriptors* const> images) {
  Pool pool;
  for (const types::Descriptors* d : images) {
    if (d->empty()) continue;
    requireFloats(*d);
    if (!pool.empty() && pool.front().first->dim() != d->dim())
      throw base::Error("[bow] the images have descriptors of " + std::to_string(pool.front().first->dim()) +
                        " and of " + std::to_string(d->dim()) + " components: use one extractor for all");
    for (std::size_t i = 0; i < d->size(); ++i) pool.emplace_back(d, i);
  }
  if (pool.empty()) throw base::Error("[bow] no descriptors to train the dictionary on");
  return pool;
}

/// Moves a random choice of n to the front and drops the rest.
void sample(Pool& pool, std::size_t n, base::Rng& rng) {
  if (pool.size() <= n) return;
  for (std::size_t i = 0; i < n; ++i)
    std::swap(pool[i], pool[i + rng.below(static_cast<std::uint32_t>(pool.size() - i))]);
  pool.resize(n);
}

/// cv::kmeans draws from the generator of the thread; this lends it a seeded one.
class SeededOpenCv {
 public:
  explicit SeededOpenCv(std::uint64_t seed) : saved_(cv::theRNG()) { cv::theRNG() = cv::RNG(seed); }
  ~SeededOpenCv() { cv::theRNG() = saved_; }
  SeededOpenCv(const SeededOpenCv&) = delete;
  SeededOpenCv& operator=(const SeededOpenCv&) = delete;

 private:
  cv::RNG saved_;
};

}  // namespace

void BowParams::describe(base::Params& p) {
  p.add("words", words, "centres of the k-means dictionary", {1, 100000});
  p.add("max_training", max_training, "descriptors the dictionary is trained on, drawn by the seed",
        {1, 1e8});
  p.add("iterations", iterations, "of k-means, at most", {1, 1000});
  p.add("seed", seed, "of the draw and of k-means", {0, std::numeric_limits<int>::max()});
}

KMeansDictionary::KMeansDictionary(std::span<const types::Descriptors* const> images,
                                   const BowParams& params) {
  base::validate(params);
  Pool pool = gather(images);
  base::Rng rng(static_cast<std::uint64_t>(params.seed));
  sample(pool, static_cast<std::size_t>(params.max_training), rng);

  const int n = static_cast<int>(pool.size());
  cv::Mat points(n, pool.front().first->dim(), CV_32F);
  for (int i = 0; i < n; ++i) {
    const auto& [image, row] = pool[static_cast<std::size_t>(i)];
    copyRow(*image, row, points.ptr<float>(i));
  }
  cv::Mat labels, centres;
  const SeededOpenCv seeded(rng.bits());
  cv::kmeans(points, std::min(params.words, n), labels,
             cv::TermCriteria(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, params.iterations, 1e-4), 1,
             cv::KMEANS_PP_CENTERS, centres);
  centres_ = Eigen::Map<const Centres>(centres.ptr<float>(), centres.rows, centres.cols);
  halfSquares_ = 0.5f * centres_.rowwise().squaredNorm();
}

std::vector<int> KMeansDictionary::wordsOf(const types::Descriptors& descriptors) const {
  std::vector<int> words(descriptors.size());
  if (words.empty()) return words;
  requireFloats(descriptors);
  if (descriptors.dim() != dim())
    throw base::Error("[bow] the dictionary has words of " + std::to_string(dim()) +
                      " components, the image " + std::to_string(descriptors.dim()) +
                      ": use the extractor of the dictionary");
  Centres queries(static_cast<Eigen::Index>(words.size()), dim());
  for (std::size_t i = 0; i < words.size(); ++i)
    copyRow(descriptors, i, queries.row(static_cast<Eigen::Index>(i)).data());

  // |x - c|² / 2 up to |x|² / 2. The product rounds; what comes within its error is compared in double.
  Centres costs = -queries * centres_.transpose();
  costs.rowwise() += halfSquares_.transpose();
  const float largest = halfSquares_.maxCoeff();
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto row = costs.row(static_cast<Eigen::Index>(i));
    const Eigen::RowVectorXd query = queries.row(static_cast<Eigen::Index>(i)).cast<double>();
    const float scale = static_cast<float>(query.squaredNorm()) + 2 * largest;
    const float bound = row.minCoeff() + 1e-5f * scale;
    double best = std::numeric_limits<double>::infinity();
    for (int w = 0; w < size(); ++w) {
      if (row[w] > bound) continue;
      const double distance = (query - centres_.row(w).cast<double>()).squaredNorm();
      if (distance < best) {
        best = distance;
        words[i] = w;
      }
    }
  }
  return words;
}

}  // namespace engram::vocabulary
