// SPDX-License-Identifier: MIT
#include "program/bench/search_bench.hpp"

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/difference_slices.hpp"
#include "seqloop/detail/sequence_search.hpp"
#include "seqloop/detail/trajectories.hpp"
#include "seqloop/place_map.hpp"
#include "synthetic/places.hpp"

namespace seqloop::program {
namespace {

// Differences cost nothing here: short descriptors will do.
constexpr std::size_t descriptor_size = 64;

MatcherConfig search_config(std::size_t ds, Arithmetic arithmetic) {
  MatcherConfig config;
  config.candidates = Candidates::all;
  config.sequence_length = ds;
  config.arithmetic = arithmetic;
  config.standardisation.on = false;
  return config;
}

PlaceMap synthetic_map(const MatcherConfig& config, std::size_t places) {
  PlaceMap map(config, {places, descriptor_size});
  SyntheticPlaces street(descriptor_size);
  std::vector<float> place(descriptor_size);
  do {
    street.see(static_cast<double>(map.size()), 0.0F, place);
  } while (map.add(place));
  return map;
}

/// A window of differences and what searches it.
struct Window {
  Window(std::size_t ds, std::size_t places, Arithmetic arithmetic)
      : config(search_config(ds, arithmetic)),
        map(synthetic_map(config, places)),
        memory(needed(), {}),
        arena(memory.span()),
        lines(arena, ds, config.vmin, config.vmax),
        queries(arena, DescriptorForm(config, descriptor_size), ds + 1),
        slices(arena, config, queries, {places, descriptor_size}),
        search(arena, lines, config, places) {
    SyntheticPlaces street(descriptor_size);
    std::vector<float> seen(descriptor_size);
    for (std::size_t frame = 0; frame < lines.window(); ++frame) {
      street.see(static_cast<double>(std::min(frame, places - 1)), 1.0F, seen);
      queries.push(seen);
      (void)slices.fill(map, frame, 0, places);
    }
  }

  [[nodiscard]] std::uint64_t needed() const {
    std::vector<BufferSize> plan;
    Arena measuring(plan);
    const Trajectories measured(measuring, config.sequence_length, config.vmin, config.vmax);
    const Capacity capacity{map.capacity(), descriptor_size};
    const QueryHistory kept(measuring, DescriptorForm(config, descriptor_size),
                            config.sequence_length + 1);
    const DifferenceSlices columns(measuring, config, kept, capacity);
    const SequenceSearch scores(measuring, measured, config, map.capacity());
    return total_bytes(plan);
  }

  void score() { (void)search.score(slices, map.order(), 0, {0, map.size()}, map.size()); }

  MatcherConfig config;
  PlaceMap map;
  ArenaMemory memory;
  Arena arena;
  Trajectories lines;
  QueryHistory queries;
  DifferenceSlices slices;
  SequenceSearch search;
};

/// Every line of every row from end to end, by blocks of rows small enough for their sums to stay
/// in the cache.
class PlainSearch {
 public:
  explicit PlainSearch(const Window& window)
      : window_(&window), sums_(rows_at_once), lowest_(window.map.size()) {}

  void score() {
    std::ranges::fill(lowest_, std::numeric_limits<float>::infinity());
    for (std::size_t first = 0; first < lowest_.size(); first += rows_at_once) {
      for (std::size_t line = 0; line < window_->lines.count(); ++line) {
        add_up(line, first, std::min(first + rows_at_once, lowest_.size()));
      }
    }
  }

 private:
  static constexpr std::size_t rows_at_once = 1024;

  void add_up(std::size_t line, std::size_t first, std::size_t last) {
    const auto offsets = window_->lines.offsets(line);
    first = std::max(first, static_cast<std::size_t>(-offsets.front()));
    const auto above = static_cast<std::size_t>(offsets.back());
    last = std::min(last, lowest_.size() - std::min(above, lowest_.size()));
    if (first >= last) return;
    std::fill_n(sums_.begin(), last - first, 0.0F);
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      const float* const column = window_->slices.column(i, float{}) + offsets[i];
      for (std::size_t row = first; row < last; ++row) sums_[row - first] += column[row];
    }
    for (std::size_t row = first; row < last; ++row) {
      lowest_[row] = std::min(lowest_[row], sums_[row - first]);
    }
  }

  const Window* window_;
  std::vector<float> sums_;
  std::vector<float> lowest_;
};

}  // namespace

void time_search(std::size_t places, std::size_t ds, std::size_t rounds,
                 std::vector<Contender>& timed) {
  const auto whole = std::make_shared<Window>(ds, places, Arithmetic::int8);
  const auto exact = std::make_shared<Window>(ds, places, Arithmetic::float32);
  const auto plain = std::make_shared<PlainSearch>(*exact);
  std::vector<Contender> contenders;
  const auto add = [&](std::string by, std::size_t value_bytes, std::function<void()> round) {
    contenders.push_back({"search", std::move(by), places, descriptor_size,
                          places * (ds + 1) * value_bytes, std::move(round)});
  };
  add("seqloop-int8", sizeof(std::uint16_t), [whole] { whole->score(); });
  add("seqloop-float", sizeof(float), [exact] { exact->score(); });
  add("plain-float", sizeof(float), [exact, plain] { plain->score(); });
  time_in_turn(std::move(contenders), rounds, timed);
}

}  // namespace seqloop::program
