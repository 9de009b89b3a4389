// SPDX-License-Identifier: MIT
#include <faiss/IndexFlat.h>
#include <faiss/IndexHNSW.h>
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>
#include <utility>

#include "peer_bench/peer.hpp"
#include "seqloop/detail/running_statistics.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop::peers {
namespace {

/// Statistics with the memory that they live in.
class Statistics {
 public:
  explicit Statistics(std::size_t size) : memory_(bytes(size), {}), arena_(memory_.span()) {
    statistics_.emplace(arena_, size);
  }
  RunningStatistics* operator->() noexcept { return &*statistics_; }
  RunningStatistics& operator*() noexcept { return *statistics_; }

 private:
  static std::uint64_t bytes(std::size_t size) {
    std::vector<BufferSize> plan;
    Arena arena(plan);
    const RunningStatistics measured(arena, size);
    return total_bytes(plan);
  }
  ArenaMemory memory_;
  Arena arena_;
  std::optional<RunningStatistics> statistics_;
};

class Nearest : public Peer {
 public:
  Nearest(bool graph, bool standardise, bool closing, std::size_t exclude)
      : graph_(graph), standardise_(standardise), closing_(closing), exclude_(exclude) {
    omp_set_num_threads(1);
  }

  void learn(const Frame& frame) override {
    if (closing_ || !standardise_) return;
    if (!learnt_) learnt_.emplace(frame.descriptor.size());
    (*learnt_)->observe(frame.descriptor);
  }

  void learnt() override {
    mapping_ = !closing_;
    start();
  }

  /// As our map and our detector do: a drive by what it was so far.
  void see(const Frame& frame) override {
    const std::span<const float> row = frame.descriptor;
    now_.assign(row.begin(), row.end());
    if (!standardise_) return;
    if (!statistics_) statistics_.emplace(row.size());
    (*statistics_)->follow(row, Standardisation{});
    static_cast<void>((*statistics_)->standardise(row, now_));
  }

  Guess find() override {
    if (!index_ || index_->ntotal == 0) return {};
    // The runner-up must not be a neighbour: so many that one is not.
    constexpr std::size_t wanted = 32;
    constexpr std::size_t neighbours = 10;
    std::array<float, wanted> squares{};
    std::array<faiss::Index::idx_t, wanted> places{};
    index_->search(1, now_.data(), wanted, squares.data(), places.data());
    if (places.front() < 0) return {};
    Guess guess{static_cast<std::size_t>(places.front()), distance(squares.front())};
    for (std::size_t i = 1; i < wanted && places.at(i) >= 0; ++i) {
      const auto place = static_cast<std::size_t>(places.at(i));
      const std::size_t apart = std::max(place, *guess.place) - std::min(place, *guess.place);
      if (apart <= neighbours) continue;
      const double second = distance(squares.at(i));
      guess.ratio = second > 0.0 ? guess.distance / second : 1.0;
      return guess;
    }
    // All the nearest are of one place: that is as sure as it can be.
    if (index_->ntotal > static_cast<faiss::Index::idx_t>(2 * wanted)) {
      const double second = distance(squares.back());
      guess.ratio = second > 0.0 ? guess.distance / second : 1.0;
    }
    return guess;
  }

  void keep() override {
    waiting_.push_back(now_);
    const std::size_t wait = mapping_ ? 0 : exclude_;
    while (waiting_.size() > wait) {
      if (!index_) make_index(now_.size());
      index_->add(1, waiting_.front().data());
      waiting_.pop_front();
    }
  }

  void begin() override {
    mapping_ = false;
    start();
  }

 private:
  static double distance(float square) {
    return std::sqrt(std::max(0.0, static_cast<double>(square)));
  }

  /// A drive starts from what was learnt.
  void start() {
    if (!learnt_) return;
    const Standardisation how;
    statistics_.emplace((*learnt_)->mean().size());
    (*statistics_)
        ->start_from(**learnt_, mapping_ ? how.prior_frames : how.prior_where_localised());
  }

  void make_index(std::size_t size) {
    const auto width = static_cast<faiss::Index::idx_t>(size);
    constexpr int links = 32;
    if (graph_) {
      index_ = std::make_unique<faiss::IndexHNSWFlat>(static_cast<int>(size), links);
    } else {
      index_ = std::make_unique<faiss::IndexFlatL2>(width);
    }
  }

  bool graph_;
  bool standardise_;
  bool closing_;
  std::size_t exclude_;
  bool mapping_ = false;
  std::optional<Statistics> learnt_;
  std::optional<Statistics> statistics_;
  std::vector<float> now_;
  std::deque<std::vector<float>> waiting_;
  std::unique_ptr<faiss::Index> index_;
};

}  // namespace

std::unique_ptr<Peer> nearest_neighbour(bool graph, bool standardise, bool closing,
                                        std::size_t exclude) {
  return std::make_unique<Nearest>(graph, standardise, closing, exclude);
}

}  // namespace seqloop::peers
