// SPDX-FileCopyrightText: 2026 The Engram authors
// SPDX-License-Identifier: BSD-3-Clause
#include "engram/vocabulary/bag_of_words.h"

#include "tf_idf.h"

#include <algorithm>

namespace engram::vocabulary {

BagOfWords::BagOfWords(const BowParams& params) : params_(params) { base::validate(params); }

void BagOfWords::rebuild(std::span<const View> views) {
  std::vector<const types::Descriptors*> images;
  for (const View& v : views) images.push_back(v.descriptors);
  dictionary_.reset();
  vectors_.clear();
  places_.clear();
  if (std::any_of(images.begin(), images.end(), [](const auto* d) { return !d->empty(); }))
    dictionary_.emplace(images, params_);

  const int words = dictionary_ ? dictionary_->size() : 0;
  for (const View& v : views) {
    places_.push_back(v.place);
    vectors_.push_back(words > 0 ? countWords(dictionary_->wordsOf(*v.descriptors), words)
                                 : Eigen::VectorXd());
  }
  idf_ = inverseDocumentFrequency(vectors_, words);
  for (Eigen::VectorXd& v : vectors_) v = tfIdf(v, idf_);
}

std::vector<double> BagOfWords::score(const types::Descriptors& query) const {
  std::vector<double> scores(vectors_.size(), 0.0);
  if (!dictionary_) return scores;
  const auto vector = tfIdf(countWords(dictionary_->wordsOf(query), dictionary_->size()), idf_);
  std::transform(vectors_.begin(), vectors_.end(), scores.begin(),
                 [&](const Eigen::VectorXd& v) { return cosineSimilarity(vector, v); });
  return scores;
}

std::size_t BagOfWords::bytes() const {
  std::size_t sum = static_cast<std::size_t>(idf_.size()) * sizeof(double);
  if (dictionary_) sum += static_cast<std::size_t>(dictionary_->centres().size()) * sizeof(float);
  for (const Eigen::VectorXd& v : vectors_) sum += static_cast<std::size_t>(v.size()) * sizeof(double);
  return sum + places_.size() * sizeof(base::PlaceId);
}

}  // namespace engram::vocabulary
