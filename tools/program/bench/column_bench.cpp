// SPDX-License-Identifier: MIT
#include "program/bench/column_bench.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "program/bench/fastest_read.hpp"
#include "program/process/available_memory.hpp"
#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/fixed_distance.hpp"
#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/detail/quantised.hpp"
#include "seqloop/detail/sketch.hpp"
#include "seqloop/difference.hpp"
#include "synthetic/places.hpp"

namespace seqloop::program {
namespace {

/// The same synthetic places in every form that is timed, and room for what comes out.
struct Places {
  explicit Places(const Capacity& capacity)
      : size(capacity),
        stride(padded_bytes(size.descriptor_size)),
        query(padded_size(size.descriptor_size)),
        small_query(stride),
        inverse_rows(size.places),
        query_sketch(sketch_words),
        dots(size.places),
        distances(size.places),
        bits(size.places),
        float_dots(size.places),
        floats(size.places),
        memory(size.places * (query.size() * sizeof(float) + stride + sketch_words * 8) +
                   3 * Arena::alignment,
               {}) {
    Arena arena(memory.span());
    rows = arena.take<float>("rows", size.places * query.size());
    small_rows = arena.take<std::int8_t>("small rows", size.places * stride);
    sketches = arena.take<std::uint64_t>("sketches", size.places * sketch_words);
    SyntheticPlaces street(size.descriptor_size);
    std::vector<SketchedValue> chosen(sketched_values(sketch_words));
    choose_sketched_values(size.descriptor_size, chosen);
    std::vector<std::uint8_t> both(2 * size.descriptor_size);
    for (std::size_t row = 0; row < size.places; ++row) {
      const std::span<float> place = rows.subspan(row * query.size(), size.descriptor_size);
      street.see(static_cast<double>(row), 0.0F, place);
      const std::span<std::int8_t> small = small_rows.subspan(row * stride, stride);
      inverse_rows[row] = inverse_length(quantise(place, small).squared_norm);
      with_negative(small.first(size.descriptor_size), both);
      sketch(both, chosen, sketches.subspan(row * sketch_words, sketch_words));
    }
    const std::span<float> unit = std::span(query).first(size.descriptor_size);
    street.see(static_cast<double>(size.places) / 2.0, 1.0F, unit);
    inverse_query = inverse_length(quantise(unit, small_query).squared_norm);
    with_negative(std::span(small_query).first(size.descriptor_size), both);
    sketch(both, chosen, query_sketch);
  }

  Capacity size;
  std::size_t stride;
  std::vector<float> query;
  std::vector<std::int8_t> small_query;
  double inverse_query = 0.0;
  std::vector<double> inverse_rows;
  std::vector<std::uint64_t> query_sketch;
  std::vector<std::int32_t> dots;
  std::vector<std::uint16_t> distances;
  std::vector<std::uint32_t> bits;
  std::vector<double> float_dots;
  std::vector<float> floats;
  ArenaMemory memory;
  std::span<float> rows;
  std::span<std::int8_t> small_rows;
  std::span<std::uint64_t> sketches;
};

std::vector<Contender> our_columns(Places& places) {
  std::vector<Contender> contenders;
  const auto add = [&](std::string by, std::size_t bytes, std::function<void()> round) {
    contenders.push_back({"column", std::move(by), places.size.places, places.size.descriptor_size,
                          bytes, std::move(round)});
  };
  add("read-bandwidth", places.small_rows.size_bytes(),
      fastest_read(std::as_bytes(places.small_rows)));
  add("read-bandwidth-float", places.rows.size_bytes(), fastest_read(std::as_bytes(places.rows)));
  for (const IntegerKernels* kernels : integer_kernels()) {
    if (!kernels->supported()) continue;
    add(fmt::format("seqloop-int8-{}", kernels->name), places.small_rows.size_bytes(),
        [&places, kernels] {
          kernels->dot_column(places.small_query.data(), places.small_rows.data(), places.stride,
                              places.size.places, places.dots.data());
          fixed_distances(places.dots, places.inverse_query, places.inverse_rows, places.distances);
        });
  }
  for (const IntegerKernels* kernels : integer_kernels()) {
    if (!kernels->supported()) continue;
    add(fmt::format("seqloop-sketch-{}", kernels->name), places.sketches.size_bytes(),
        [&places, kernels] {
          kernels->hamming_column(places.query_sketch.data(), places.sketches.data(), sketch_words,
                                  places.size.places, places.bits.data());
        });
  }
  add("seqloop-float", places.rows.size_bytes(), [&places] {
    best_float_kernels().dots(places.query.data(), places.rows.data(), places.query.size(),
                              places.size.places, places.float_dots.data());
    std::ranges::transform(places.float_dots, places.floats.begin(),
                           [](double dot) { return euclidean(1.0, 1.0, dot); });
  });
  return contenders;
}

}  // namespace

void time_columns(const Capacity& size, std::size_t graph_places, const PeerColumns& peers,
                  std::size_t rounds, std::vector<Contender>& timed) {
  const std::size_t copies = !peers ? 1 : size.places <= graph_places ? 3 : 2;
  const std::uint64_t floats =
      std::uint64_t{size.places} * padded_size(size.descriptor_size) * sizeof(float);
  const std::uint64_t bytes =
      std::uint64_t{size.places} * padded_bytes(size.descriptor_size) + copies * floats;
  if (!fits_memory(bytes, fmt::format("column of {} places", size.places))) return;
  Places places(size);
  std::vector<Contender> contenders = our_columns(places);
  if (peers) {
    for (Contender& peer : peers({size, places.query, places.rows, size.places <= graph_places})) {
      contenders.push_back(std::move(peer));
    }
  }
  time_in_turn(std::move(contenders), rounds, timed);
}

}  // namespace seqloop::program
