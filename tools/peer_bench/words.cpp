// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstring>
#include <deque>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "peer_bench/peer.hpp"
#include "peer_bench/vocabulary.hpp"

namespace seqloop::peers {
namespace {

constexpr int features_a_picture = 500;
constexpr int least_width = 320;  // smaller pictures are enlarged, or ORB finds nothing
constexpr std::size_t learnt_at_most = 500'000;  // features
constexpr std::size_t candidates = 50;           // places that islands are made of
constexpr std::size_t gap = 3;                   // rows between two of an island

/// What is kept of a picture.
struct Features {
  std::vector<Bits> bits;
  std::vector<cv::Point2f> points;
  std::vector<std::pair<std::size_t, float>> words;  // ascending; weights add up to 1
};

class Words : public Peer {
 public:
  explicit Words(std::size_t exclude) : exclude_(exclude) {
    cv::setNumThreads(1);
    cv::setRNGSeed(1);
  }

  void learn(const Frame& frame) override {
    // Every so many frames, thinned where the drive turns out long.
    if (learnt_frames_++ % every_ != 0) return;
    Features some = extract(frame);
    samples_.insert(samples_.end(), some.bits.begin(), some.bits.end());
    sample_sizes_.push_back(some.bits.size());
    if (samples_.size() > learnt_at_most) thin();
  }

  void learnt() override {
    std::vector<Bits> shuffled = samples_;
    vocabulary_.learn(shuffled);
    std::vector<std::size_t> frames(vocabulary_.words(), 0);
    std::size_t at = 0;
    for (const std::size_t size : sample_sizes_) {
      std::vector<std::size_t> seen;
      for (std::size_t i = 0; i < size; ++i) seen.push_back(vocabulary_.word(samples_[at + i]));
      at += size;
      std::ranges::sort(seen);
      seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
      for (const std::size_t word : seen) ++frames[word];
    }
    const auto all = static_cast<double>(std::max<std::size_t>(1, sample_sizes_.size()));
    for (const std::size_t count : frames) {
      rarity_.push_back(
          static_cast<float>(std::log(all / static_cast<double>(std::max<std::size_t>(1, count)))));
    }
    inverted_.resize(vocabulary_.words());
    samples_ = {};
    mapping_ = true;
  }

  void see(const Frame& frame) override {
    before_ = std::exchange(now_, extract(frame)).words;
    std::vector<std::size_t> seen;
    for (const Bits& feature : now_.bits) seen.push_back(vocabulary_.word(feature));
    std::ranges::sort(seen);
    float sum = 0.0F;
    for (const std::size_t word : seen) {
      if (now_.words.empty() || now_.words.back().first != word)
        now_.words.emplace_back(word, 0.0F);
      now_.words.back().second += rarity_[word];
      sum += rarity_[word];
    }
    for (auto& [word, weight] : now_.words) weight /= std::max(sum, 1e-9F);
  }

  Guess find() override {
    // By this a frame is compared with the one before it: what could be expected at best.
    const double expected = alike(now_.words, before_);
    constexpr double least_expected = 0.005;
    if (places_.empty() || expected < least_expected) return {};
    scores_.assign(places_.size(), 0.0F);
    for (const auto& [word, weight] : now_.words) {
      for (const auto& [place, other] : inverted_[word]) scores_[place] += std::min(weight, other);
    }
    std::vector<std::size_t> best(places_.size());
    for (std::size_t i = 0; i < best.size(); ++i) best[i] = i;
    const std::size_t taken = std::min(candidates, best.size());
    std::ranges::partial_sort(
        best, best.begin() + static_cast<std::ptrdiff_t>(taken),
        [&](std::size_t a, std::size_t b) { return scores_[a] > scores_[b]; });
    best.resize(taken);
    const auto [place, second] = islands(best);
    const auto score = static_cast<double>(scores_[place]);
    if (score <= 0.0) return {};
    return {place, 1.0 - std::min(1.0, score / expected),
            std::min(1.0, static_cast<double>(second) / score), agreeing(places_[place])};
  }

  void keep() override {
    waiting_.push_back(now_);
    const std::size_t wait = mapping_ ? 0 : exclude_;
    while (waiting_.size() > wait) {
      for (const auto& [word, weight] : waiting_.front().words) {
        inverted_[word].emplace_back(static_cast<std::uint32_t>(places_.size()), weight);
      }
      places_.push_back(std::move(waiting_.front()));
      waiting_.pop_front();
    }
  }

  void begin() override { mapping_ = false; }

 private:
  Features extract(const Frame& frame) {
    const Image& image = frame.image;
    // OpenCV has no view of memory that it may not write.
    auto* const data = const_cast<std::uint8_t*>(image.data);  // NOLINT(*-const-cast)
    const bool gray = image.format == PixelFormat::gray8;
    cv::Mat picture(image.height, image.width, gray ? CV_8UC1 : CV_8UC3, data, image.stride);
    if (!gray) cv::cvtColor(picture, picture, cv::COLOR_BGR2GRAY);
    if (picture.cols < least_width) {
      const double by = static_cast<double>(least_width) / picture.cols;
      cv::resize(picture, picture, {}, by, by, cv::INTER_CUBIC);
    }
    std::vector<cv::KeyPoint> points;
    cv::Mat rows;
    orb_->detectAndCompute(picture, cv::noArray(), points, rows);
    Features features;
    for (int row = 0; row < rows.rows; ++row) {
      std::memcpy(features.bits.emplace_back().data(), rows.ptr(row), sizeof(Bits));
      features.points.push_back(points[static_cast<std::size_t>(row)].pt);
    }
    return features;
  }

  /// Every second frame of what was taken goes.
  void thin() {
    std::vector<Bits> kept;
    std::vector<std::size_t> sizes;
    std::size_t at = 0;
    for (std::size_t frame = 0; frame < sample_sizes_.size(); ++frame) {
      const auto first = samples_.begin() + static_cast<std::ptrdiff_t>(at);
      if (frame % 2 == 0) {
        kept.insert(kept.end(), first, first + static_cast<std::ptrdiff_t>(sample_sizes_[frame]));
        sizes.push_back(sample_sizes_[frame]);
      }
      at += sample_sizes_[frame];
    }
    samples_ = std::move(kept);
    sample_sizes_ = std::move(sizes);
    every_ *= 2;
  }

  /// 1 less half of the L1 distance, as DBoW2 scores.
  static double alike(const std::vector<std::pair<std::size_t, float>>& a,
                      const std::vector<std::pair<std::size_t, float>>& b) {
    double sum = 0.0;
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
      if (a[i].first < b[j].first) {
        ++i;
      } else if (b[j].first < a[i].first) {
        ++j;
      } else {
        sum += static_cast<double>(std::min(a[i++].second, b[j++].second));
      }
    }
    return sum;
  }

  /// The best place of the island with the highest sum, and the best score outside of it.
  [[nodiscard]] std::pair<std::size_t, float> islands(std::vector<std::size_t> best) const {
    std::ranges::sort(best);
    std::size_t place = best.front();
    std::pair<std::size_t, std::size_t> winner{0, 0};
    float most = -1.0F;
    for (std::size_t first = 0; first < best.size();) {
      std::size_t last = first;
      while (last + 1 < best.size() && best[last + 1] - best[last] <= gap) ++last;
      float sum = 0.0F;
      std::size_t top = best[first];
      for (std::size_t i = first; i <= last; ++i) {
        sum += scores_[best[i]];
        if (scores_[best[i]] > scores_[top]) top = best[i];
      }
      if (sum > most) {
        most = sum;
        place = top;
        winner = {first, last};
      }
      first = last + 1;
    }
    float second = 0.0F;
    for (std::size_t i = 0; i < best.size(); ++i) {
      if (i < winner.first || i > winner.second) second = std::max(second, scores_[best[i]]);
    }
    return {place, second};
  }

  /// How many features are where one fundamental matrix puts them.
  [[nodiscard]] std::size_t agreeing(const Features& place) const {
    constexpr double clear = 0.8;  // best by second best
    constexpr std::size_t least = 8;
    std::vector<cv::Point2f> here;
    std::vector<cv::Point2f> there;
    for (std::size_t i = 0; i < now_.bits.size(); ++i) {
      unsigned first = 257;
      unsigned second = 257;
      std::size_t match = 0;
      for (std::size_t j = 0; j < place.bits.size(); ++j) {
        const unsigned distance = differing(now_.bits[i], place.bits[j]);
        if (distance < first) {
          second = std::exchange(first, distance);
          match = j;
        } else {
          second = std::min(second, distance);
        }
      }
      if (first >= clear * second) continue;
      here.push_back(now_.points[i]);
      there.push_back(place.points[match]);
    }
    if (here.size() < least) return 0;
    cv::Mat inliers;
    constexpr double pixels = 2.0;
    constexpr double confidence = 0.99;
    const cv::Mat matrix =
        cv::findFundamentalMat(here, there, cv::FM_RANSAC, pixels, confidence, inliers);
    return matrix.empty() ? 0 : static_cast<std::size_t>(cv::countNonZero(inliers));
  }

  std::size_t exclude_;
  cv::Ptr<cv::ORB> orb_ = cv::ORB::create(features_a_picture);
  std::size_t learnt_frames_ = 0;
  std::size_t every_ = 1;
  std::vector<Bits> samples_;
  std::vector<std::size_t> sample_sizes_;
  bool mapping_ = false;
  Vocabulary vocabulary_;
  std::vector<float> rarity_;  // by word: how few frames have it
  std::vector<std::vector<std::pair<std::uint32_t, float>>> inverted_;  // by word: place, weight
  Features now_;
  std::vector<std::pair<std::size_t, float>> before_;
  std::deque<Features> waiting_;
  std::vector<Features> places_;
  std::vector<float> scores_;
};

}  // namespace

std::unique_ptr<Peer> bag_of_words(std::size_t exclude) { return std::make_unique<Words>(exclude); }

}  // namespace seqloop::peers
