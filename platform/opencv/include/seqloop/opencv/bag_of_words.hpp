// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "seqloop/describer.hpp"
#include "seqloop/frame_source.hpp"

namespace seqloop::opencv {

/// A plain bag of visual words, as a baseline: up to 500 ORB features a picture, each counted as
/// the nearest word of a vocabulary (Hamming distance), the counts weighed by how rare a word is
/// (tf-idf), unit L2. It stands where FAB-MAP would stand and is not FAB-MAP, which learns which
/// words go together and gives a probability.
///
/// ORB leaves out a margin of 31 pixels, so pictures of less than about 100 pixels a side have
/// hardly a feature, and are `blank`; pictures are described at the size at which they come.
class BagOfWords : public Describer {
 public:
  static constexpr std::size_t most_features = 20'000;  ///< that words are learned from

  /// Learns the vocabulary by k-means on up to most_features of the drives' features, drawn at
  /// random from a fixed seed, and how rare the words are. The same pictures give the same words.
  /// @param training drives, read to their ends; what cannot be read is left out
  /// @param words    D, from 1 to the number of features sampled
  /// @param between  called before each look at a picture and each round of k-means; what it throws
  ///   ends the learning
  /// Throws SetupError: more words than features; nothing that tells the pictures apart.
  /// Work: ORB of every picture, some 25 * most_features * words distances of 256 values.
  /// Allocates: while learning 16 kB a picture and 20 MB; 36 bytes a word stay.
  explicit BagOfWords(std::span<FrameSource* const> training, std::size_t words = 500,
                      const std::function<void()>& between = {});
  BagOfWords(const BagOfWords&) = delete;
  BagOfWords& operator=(const BagOfWords&) = delete;
  BagOfWords(BagOfWords&&) = delete;
  BagOfWords& operator=(BagOfWords&&) = delete;
  ~BagOfWords() override;

  /// Words.
  [[nodiscard]] std::size_t size() const noexcept override;

  /// Grey pictures at the size at which they come.
  [[nodiscard]] PictureNeeds needs() const noexcept override;

  /// `blank`, the zero vector, for a picture without a feature, or with words only that every
  /// training picture has. `failed` for an empty picture and a span that is not [D].
  /// Work: ORB and up to 500 D Hamming distances. Allocates: OpenCV does.
  [[nodiscard]] Description describe(const Image& image,
                                     std::span<float> descriptor) noexcept override;

  [[nodiscard]] std::string_view last_fault() const noexcept override;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace seqloop::opencv
