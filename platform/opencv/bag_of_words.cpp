// SPDX-License-Identifier: MIT
#include "seqloop/opencv/bag_of_words.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "opencv/detail/guarded.hpp"
#include "opencv/detail/one_line.hpp"
#include "opencv/detail/training.hpp"
#include "seqloop/difference.hpp"
#include "seqloop/fault.hpp"

namespace seqloop::opencv {
namespace {

constexpr int features_a_picture = 500;
constexpr int feature_bytes = 32;  // of an ORB feature
constexpr int bits = 8 * feature_bytes;
constexpr std::uint64_t seed = 1;

/// What k-means draws comes from this thread's generator, which is left as it was.
class FixedSeed {
 public:
  FixedSeed() : before_(cv::theRNG().state) { cv::theRNG().state = seed; }
  FixedSeed(const FixedSeed&) = delete;
  FixedSeed& operator=(const FixedSeed&) = delete;
  FixedSeed(FixedSeed&&) = delete;
  FixedSeed& operator=(FixedSeed&&) = delete;
  ~FixedSeed() { cv::theRNG().state = before_; }

 private:
  std::uint64_t before_;
};

/// ORB features of a picture, [count, 32] bytes.
class Features {
 public:
  /// May throw cv::Exception.
  [[nodiscard]] const cv::Mat& find(const Image& image) {
    cv::Mat picture = matrix(image);
    if (picture.channels() == 3) {
      cv::cvtColor(picture, gray_, cv::COLOR_BGR2GRAY);
      picture = gray_;
    }
    orb_->detectAndCompute(picture, cv::noArray(), keypoints_, features_);
    return features_;
  }

 private:
  cv::Ptr<cv::ORB> orb_ = cv::ORB::create(features_a_picture);
  cv::Mat gray_;
  std::vector<cv::KeyPoint> keypoints_;
  cv::Mat features_;
};

void unpack(const std::uint8_t* feature, float* values) {
  for (int bit = 0; bit < bits; ++bit)
    values[bit] = static_cast<float>(feature[bit / 8] >> (bit % 8) & 1);
}

/// @return [count, 256] of 0 and 1: all features, or most_features drawn from them in order
cv::Mat sample(const std::vector<cv::Mat>& pictures) {
  std::size_t left = 0;
  for (const cv::Mat& features : pictures) left += static_cast<std::size_t>(features.rows);
  std::size_t wanted = std::min(left, BagOfWords::most_features);
  cv::Mat values(static_cast<int>(wanted), bits, CV_32F);
  cv::RNG random(seed);
  for (const cv::Mat& features : pictures) {
    for (int row = 0; row < features.rows; ++row, --left) {
      // Each of those left is as likely as the others to be among those wanted.
      if (random.uniform(0.0, 1.0) * static_cast<double>(left) >= static_cast<double>(wanted))
        continue;
      unpack(features.ptr(row), values.ptr<float>(values.rows - static_cast<int>(wanted)));
      --wanted;
    }
  }
  return values;
}

/// @return [words, 32] bytes: each bit as most of the word's features have it
cv::Mat learn_words(const cv::Mat& values, int words, const std::function<void()>& between) {
  constexpr int rounds = 19;
  // No fewer are done in one call: features go to their centres, and centres among their features.
  // Going on from labels begins with the latter once more, which changes nothing.
  const cv::TermCriteria one(cv::TermCriteria::COUNT, 2, 0.0);
  const FixedSeed fixed;
  cv::Mat labels;
  cv::Mat centres;
  for (int round = 0; round < rounds; ++round) {
    if (between) between();
    const int start = round == 0 ? cv::KMEANS_PP_CENTERS : cv::KMEANS_USE_INITIAL_LABELS;
    cv::kmeans(values, words, labels, one, 1, start, centres);
  }
  cv::Mat vocabulary = cv::Mat::zeros(words, feature_bytes, CV_8U);
  for (int word = 0; word < words; ++word)
    for (int bit = 0; bit < bits; ++bit)
      if (centres.at<float>(word, bit) > 0.5F)
        vocabulary.at<std::uint8_t>(word, bit / 8) |= static_cast<std::uint8_t>(1 << (bit % 8));
  return vocabulary;
}

}  // namespace

class BagOfWords::Impl {
 public:
  Impl(std::span<FrameSource* const> training, std::size_t words,
       const std::function<void()>& between)
      : weights_(words) {
    std::vector<cv::Mat> pictures;
    const TrainingCount count = for_each_picture(training, [&](const Image& image) {
      if (between) between();
      pictures.push_back(features_.find(image).clone());
    });
    const cv::Mat values = sample(pictures);
    if (words == 0 || words > static_cast<std::size_t>(values.rows)) {
      throw SetupError(
          Fault{"words",
                std::to_string(words) + " cannot be learned from the " +
                    std::to_string(values.rows) + " features of training with " + text(count),
                "ask for at least 1 and no more than there are features, or give drives with "
                "larger pictures or more of them"});
    }
    try {
      vocabulary_ = learn_words(values, static_cast<int>(words), between);
      weigh(pictures, between);
    } catch (const cv::Exception& error) {
      throw SetupError(Fault{"words", "OpenCV cannot learn them (" + one_line(error.err) + ")"});
    }
  }

  /// May throw.
  [[nodiscard]] Description describe(const Image& image, std::span<float> descriptor) {
    count_words(features_.find(image), descriptor);
    for (std::size_t word = 0; word < descriptor.size(); ++word) descriptor[word] *= weights_[word];
    return normalise(descriptor) ? Description::good : Description::blank;
  }

  [[nodiscard]] std::size_t size() const noexcept { return weights_.size(); }
  [[nodiscard]] std::string& fault() noexcept { return fault_; }

 private:
  void count_words(const cv::Mat& features, std::span<float> counts) {
    std::ranges::fill(counts, 0.0F);
    if (features.empty()) return;
    cv::batchDistance(features, vocabulary_, distances_, CV_32S, nearest_, cv::NORM_HAMMING, 1);
    for (int row = 0; row < nearest_.rows; ++row)
      counts[static_cast<std::size_t>(nearest_.at<int>(row))] += 1.0F;
  }

  /// A word's weight: the logarithm of how many pictures there are for one that has it.
  void weigh(const std::vector<cv::Mat>& pictures, const std::function<void()>& between) {
    std::vector<float> counts(weights_.size());
    std::vector<std::size_t> having(weights_.size());
    for (const cv::Mat& features : pictures) {
      if (between) between();
      count_words(features, counts);
      for (std::size_t word = 0; word < counts.size(); ++word)
        if (counts[word] > 0.0F) ++having[word];
    }
    const auto all = static_cast<double>(pictures.size());
    for (std::size_t word = 0; word < having.size(); ++word) {
      // What no training picture has is as rare as what one has.
      const auto some = static_cast<double>(std::max<std::size_t>(having[word], 1));
      weights_[word] = static_cast<float>(std::log(all / some));
    }
    if (squared_norm(weights_) == 0.0) {
      throw SetupError(Fault{"words", "every training picture has each of them",
                             "give drives with more pictures, or ask for more words"});
    }
  }

  Features features_;
  cv::Mat vocabulary_;          // [words, 32]
  std::vector<float> weights_;  // [words]
  cv::Mat distances_;
  cv::Mat nearest_;
  std::string fault_;
};

BagOfWords::BagOfWords(std::span<FrameSource* const> training, std::size_t words,
                       const std::function<void()>& between)
    : impl_(std::make_unique<Impl>(training, words, between)) {}

BagOfWords::~BagOfWords() = default;

std::size_t BagOfWords::size() const noexcept { return impl_->size(); }

PictureNeeds BagOfWords::needs() const noexcept { return {.gray_is_enough = true}; }

Description BagOfWords::describe(const Image& image, std::span<float> descriptor) noexcept {
  return guarded(impl_->fault(), image, descriptor, size(),
                 [&] { return impl_->describe(image, descriptor); });
}

std::string_view BagOfWords::last_fault() const noexcept { return impl_->fault(); }

}  // namespace seqloop::opencv
