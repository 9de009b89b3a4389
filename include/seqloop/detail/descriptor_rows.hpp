// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "seqloop/detail/arena.hpp"
#include "seqloop/detail/float_kernels.hpp"
#include "seqloop/detail/integer_kernels.hpp"
#include "seqloop/detail/sketch.hpp"
#include "seqloop/matcher_config.hpp"

namespace seqloop {

/// How each descriptor is kept.
struct DescriptorForm {
  DescriptorForm(const MatcherConfig& config, std::size_t descriptor_size) noexcept;

  Difference difference;
  Arithmetic arithmetic;
  bool scanned;      ///< whether there are sketches to scan the map by
  std::size_t size;  ///< D

  bool operator==(const DescriptorForm&) const = default;

  /// What a difference of 1 is in the whole numbers that `int8` and `sketch` compare by.
  [[nodiscard]] double unit() const noexcept;
};

/// What the buffers of some rows are called in a plan.
struct RowNames {
  std::string_view values;
  std::string_view lengths;
  std::string_view sketches;
};

/// Descriptors side by side, in the form in which they are compared.
class DescriptorRows {
 public:
  /// Words of a sketch that relocalising scans the map by, and those that it looks closely by.
  static constexpr std::size_t scanned_words = 4;
  static constexpr std::size_t close_words = 16;
  static constexpr double close_bits = close_words * 64.0;

  /// Rows that several queries are compared with in one go: what is not near any more when the
  /// queries go on at the other end of their ring is still in the second-level cache.
  static constexpr std::size_t block_rows = 96;

  /// Allocates: from the arena only.
  DescriptorRows(Arena& arena, const RowNames& names, const DescriptorForm& form, std::size_t rows);

  /// @param descriptor [D] finite. Work: D, and the sketch. Allocates: never.
  void store(std::size_t row, std::span<const float> descriptor) noexcept;

  /// Takes over a row that is kept in the same form. Work: a copy.
  void copy(std::size_t row, const DescriptorRows& from, std::size_t from_row) noexcept;

  /// Bytes that a row is saved in: what cannot be computed from something else.
  [[nodiscard]] std::size_t saved_size() const noexcept;

  /// Writes a row's bytes, the same on every processor: integers as in memory, floats and words the
  /// lowest byte first.
  /// @param out [saved_size()]. Work: a copy. Allocates: never.
  void save(std::size_t row, std::span<std::byte> out) const noexcept;

  /// Whether a descriptor can have been saved like that: floats are finite, and of the whole
  /// numbers none is the lowest. @param saved [saved_size()]. Work: D. Allocates: never.
  [[nodiscard]] static bool can_be_saved(Arithmetic arithmetic,
                                         std::span<const std::byte> saved) noexcept;

  /// Takes over a row that was saved, in the same form; its sketch is left to `sketch`.
  /// @param saved [saved_size()]
  /// @return false when no descriptor is saved like that; then the row is as it was
  /// Work: D. Allocates: never.
  [[nodiscard]] bool load(std::size_t row, std::span<const std::byte> saved) noexcept;

  /// Makes the sketches of rows that were loaded: of many at once in a fraction of the time.
  /// @param rows up to `sketched_together`
  /// @param room [sketch_room()]
  /// Allocates: never.
  void sketch(std::span<const std::size_t> rows, std::span<std::uint8_t> room) noexcept;

  /// Values that `sketch` needs room for; none where rows are sketched one by one.
  [[nodiscard]] static std::uint64_t sketch_room(const DescriptorForm& form) noexcept;

  /// Differences of one descriptor to consecutive rows, for `float32`.
  /// @param out [count] 0 .. 2 between unit vectors. Work: count distances. Allocates: never.
  void compare(const DescriptorRows& queries, std::size_t query, std::size_t first,
               std::span<float> out) const noexcept;

  /// The same for `int8` and `sketch`. @param out [count] 0 .. 65,534, in `unit()`s
  void compare(const DescriptorRows& queries, std::size_t query, std::size_t first,
               std::span<std::uint16_t> out) const noexcept;

  /// The same of several descriptors, reading each row once for all of them; `float32` by
  /// Euclid, and `int8`.
  /// @param query rows of the queries from this one on; behind their last follows their first
  /// @param out   one column a query, at most `MatcherConfig::most_frames_at_once`
  void compare(const DescriptorRows& queries, std::size_t query,
               std::span<const std::span<float>> out) const noexcept;
  void compare(const DescriptorRows& queries, std::size_t query,
               std::span<const std::span<std::uint16_t>> out) const noexcept;

  /// The difference of two, 0 .. 2 between unit vectors.
  [[nodiscard]] double between(std::size_t a, std::size_t b) const noexcept {
    return difference(*this, a, b);
  }

  /// The same of a query and a row.
  [[nodiscard]] double difference(const DescriptorRows& queries, std::size_t query,
                                  std::size_t row) const noexcept;

  /// Differing bits of the scanned words of one sketch and consecutive ones.
  /// @param out [count] 0 .. 64 scanned_words. Work: count * scanned_words.
  void scan(const DescriptorRows& queries, std::size_t query, std::size_t first,
            std::span<std::uint32_t> out) const noexcept;

  /// Differing bits of the close words of two sketches. @return 0 .. 64 close_words
  [[nodiscard]] std::uint32_t look_closely(const DescriptorRows& queries, std::size_t query,
                                           std::size_t row) const noexcept {
    return look_closely(queries.close_sketch(query), row);
  }
  [[nodiscard]] std::uint32_t look_closely(std::span<const std::uint64_t, close_words> sketch,
                                           std::size_t row) const noexcept {
    return kernels_->hamming(sketch.data(), &sketches_[row * words_], close_words);
  }

  /// The close words of a row's sketch.
  [[nodiscard]] std::span<const std::uint64_t, close_words> close_sketch(
      std::size_t row) const noexcept {
    return std::span<const std::uint64_t, close_words>(&sketches_[row * words_], close_words);
  }

  /// Has the processor fetch the sketches of consecutive rows, which will be looked at soon.
  void prefetch_sketches(std::size_t first, std::size_t count) const noexcept;

  /// About what was stored, to show or to save: exact for `float32`, to half a 127th of the largest
  /// value for `int8`, signs for `sketch`.
  /// @param out [restored_size()] unit L2 or zero, where that went in; zero beyond D
  void restore(std::size_t row, std::span<float> out) const noexcept;
  [[nodiscard]] std::size_t restored_size() const noexcept;

  [[nodiscard]] const DescriptorForm& form() const noexcept { return form_; }

 private:
  /// Of floats: from dot products of a query with rows from `first` on.
  void distances(std::span<const double> dots, double query_square, std::size_t first,
                 std::span<float> out) const noexcept;
  void measure(std::size_t row) noexcept;
  void sketch_row(std::size_t row, std::span<const std::int8_t> bytes) noexcept;
  void copy_scanned(std::size_t row) noexcept;
  [[nodiscard]] std::span<const float> exact(std::size_t row) const noexcept {
    return exact_.subspan(row * stride_, stride_);
  }
  [[nodiscard]] std::span<std::int8_t> small(std::size_t row) const noexcept {
    return small_.subspan(row * stride_, stride_);
  }

  DescriptorForm form_;
  const IntegerKernels* kernels_;
  const FloatKernels* float_kernels_;
  std::size_t stride_;                // values from row to row
  std::size_t words_;                 // of a sketch
  std::span<float> exact_;            // [rows, stride], float32
  std::span<std::int8_t> small_;      // [rows, stride], int8
  std::span<double> lengths_;         // [rows], int8: one over them; float32: their squares
  std::span<std::int8_t> quantised_;  // [stride], what only a sketch is made of
  std::span<std::uint8_t> both_;      // [2 D], a descriptor and its negative
  std::span<SketchedValue> sketched_values_;
  std::span<std::uint64_t> sketches_;  // [rows, words_]
  std::span<std::uint64_t> scanned_;   // [rows, scanned_words]: these words again, side by side
};

/// The close words of a frame's sketch.
using CloseSketch = std::span<const std::uint64_t, DescriptorRows::close_words>;

}  // namespace seqloop
