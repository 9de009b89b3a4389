// SPDX-License-Identifier: MIT
#include "seqloop/detail/descriptor_rows.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "seqloop/detail/fixed_distance.hpp"
#include "seqloop/detail/quantised.hpp"
#include "seqloop/detail/sketch.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

// Whole numbers on their way to differences: few enough for the first-level cache.
constexpr std::size_t abreast = 256;

// -128 as a byte: values of a descriptor are symmetric.
constexpr int no_value = 0x80;

constexpr double sketch_bits = 64.0 * static_cast<double>(sketch_words);

std::size_t stride_of(const DescriptorForm& form) {
  return form.arithmetic == Arithmetic::float32 ? padded_size(form.size) : padded_bytes(form.size);
}

std::size_t words_of(const DescriptorForm& form) {
  if (form.arithmetic == Arithmetic::sketch) return sketch_words;
  return form.scanned ? DescriptorRows::close_words : 0;
}

/// Whether differences come from dot products.
bool by_dots(const DescriptorForm& form) {
  return form.difference == Difference::euclidean && form.arithmetic != Arithmetic::sketch;
}

constexpr std::size_t block_abreast = DescriptorRows::block_rows;

/// Calls `work(begin, count)` for pieces of at most `most`.
template <class Work>
void in_pieces(std::size_t count, std::size_t most, Work work) {
  for (std::size_t begin = 0; begin < count; begin += most) {
    work(begin, std::min(most, count - begin));
  }
}

/// Consecutive queries and rows that are compared in one go.
template <class Value>
struct QueriesByRows {
  std::size_t query;
  std::span<const std::span<Value>> columns;  // one a query
  std::size_t row;
  std::size_t count;
};

/// Calls `work(block)` for rows that are few enough, and for all queries: for those up to the end
/// of their ring, and for those from its beginning on.
template <class Value, class Work>
void in_blocks(std::size_t ring, std::size_t query, std::span<const std::span<Value>> columns,
               Work work) {
  if (columns.empty()) return;
  const std::size_t before_end = std::min(columns.size(), ring - query);
  in_pieces(columns.front().size(), block_abreast, [&](std::size_t row, std::size_t count) {
    work(QueriesByRows<Value>{query, columns.first(before_end), row, count});
    if (before_end == columns.size()) return;
    work(QueriesByRows<Value>{0, columns.subspan(before_end), row, count});
  });
}

/// Writes a number, the lowest byte first.
template <class Number>
void put(Number number, std::span<std::byte> out) {
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    out[i] = static_cast<std::byte>(number >> (8 * i));
  }
}

template <class Number>
Number taken(std::span<const std::byte> bytes) {
  Number number = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i) {
    number |= static_cast<Number>(std::to_integer<Number>(bytes[i]) << (8 * i));
  }
  return number;
}

}  // namespace

DescriptorForm::DescriptorForm(const MatcherConfig& config, std::size_t descriptor_size) noexcept
    : difference(config.difference),
      arithmetic(config.arithmetic),
      scanned(scans(config)),
      size(descriptor_size) {}

double DescriptorForm::unit() const noexcept {
  // All bits of a sketch are as far apart as opposite vectors.
  return arithmetic == Arithmetic::sketch ? sketch_bits / 2.0 : fixed_distance_one;
}

DescriptorRows::DescriptorRows(Arena& arena, const RowNames& names, const DescriptorForm& form,
                               std::size_t rows)
    : form_(form),
      kernels_(&best_integer_kernels()),
      float_kernels_(&best_float_kernels()),
      stride_(stride_of(form)),
      words_(words_of(form)),
      exact_(arena.take<float>(names.values, form.arithmetic == Arithmetic::float32
                                                 ? std::uint64_t{rows} * stride_
                                                 : 0)),
      small_(arena.take<std::int8_t>(
          names.values, form.arithmetic == Arithmetic::int8 ? std::uint64_t{rows} * stride_ : 0)),
      lengths_(arena.take<double>(names.lengths, by_dots(form) ? rows : 0)),
      quantised_(arena.take<std::int8_t>(
          "what a sketch is made of",
          words_ > 0 && form.arithmetic != Arithmetic::int8 ? padded_bytes(form.size) : 0)),
      both_(arena.take<std::uint8_t>("what a sketch is made of",
                                     words_ > 0 ? std::uint64_t{2} * form.size : 0)),
      sketched_values_(
          arena.take<SketchedValue>("what a sketch is made of", sketched_values(words_))),
      sketches_(arena.take<std::uint64_t>(names.sketches, std::uint64_t{rows} * words_)),
      scanned_(arena.take<std::uint64_t>(names.sketches,
                                         form.scanned ? std::uint64_t{rows} * scanned_words : 0)) {
  choose_sketched_values(form.size, sketched_values_);
}

void DescriptorRows::store(std::size_t row, std::span<const float> descriptor) noexcept {
  if (form_.arithmetic == Arithmetic::float32) {
    std::ranges::copy(descriptor, exact_.subspan(row * stride_, stride_).begin());
    measure(row);
  }
  std::span<std::int8_t> bytes = quantised_;
  if (form_.arithmetic == Arithmetic::int8) {
    bytes = small(row);
    lengths_[row] = inverse_length(quantise(descriptor, bytes).squared_norm);
  } else if (words_ > 0) {
    quantise(descriptor, bytes);
  }
  sketch_row(row, bytes);
}

void DescriptorRows::measure(std::size_t row) noexcept {
  if (lengths_.empty()) return;
  float_kernels_->dots(exact(row).data(), exact(row).data(), stride_, 1, &lengths_[row]);
}

void DescriptorRows::sketch_row(std::size_t row, std::span<const std::int8_t> bytes) noexcept {
  if (words_ == 0) return;
  with_negative(bytes.first(form_.size), both_);
  seqloop::sketch(both_, sketched_values_, sketches_.subspan(row * words_, words_));
  copy_scanned(row);
}

void DescriptorRows::copy_scanned(std::size_t row) noexcept {
  if (!form_.scanned) return;
  std::ranges::copy(sketches_.subspan(row * words_, scanned_words),
                    scanned_.subspan(row * scanned_words).begin());
}

std::uint64_t DescriptorRows::sketch_room(const DescriptorForm& form) noexcept {
  const bool beside = form.arithmetic == Arithmetic::int8 && form.scanned;
  return beside ? side_by_side_values(form.size) : 0;
}

void DescriptorRows::sketch(std::span<const std::size_t> rows,
                            std::span<std::uint8_t> room) noexcept {
  if (words_ == 0 || rows.empty() || form_.arithmetic == Arithmetic::sketch) return;
  if (form_.arithmetic == Arithmetic::float32) {
    for (const std::size_t row : rows) {
      quantise(exact(row).first(form_.size), quantised_);
      sketch_row(row, quantised_);
    }
    return;
  }
  if (rows.size() == 1) return sketch_row(rows.front(), small(rows.front()));
  // Where there are fewer, the last one is sketched several times.
  std::array<const std::int8_t*, sketched_together> descriptors;
  std::array<std::uint64_t*, sketched_together> sketches;
  for (std::size_t i = 0; i < sketched_together; ++i) {
    const std::size_t row = rows[std::min(i, rows.size() - 1)];
    descriptors[i] = small(row).data();
    sketches[i] = &sketches_[row * words_];
  }
  side_by_side(descriptors, form_.size, room);
  kernels_->sketch_together(room.data(), sketched_values_.data(), words_, sketches.data());
  for (const std::size_t row : rows) copy_scanned(row);
}

std::size_t DescriptorRows::saved_size() const noexcept {
  switch (form_.arithmetic) {
    case Arithmetic::float32:
      return form_.size * sizeof(float);
    case Arithmetic::int8:
      return form_.size;
    case Arithmetic::sketch:
      return words_ * sizeof(std::uint64_t);
  }
  return 0;
}

void DescriptorRows::save(std::size_t row, std::span<std::byte> out) const noexcept {
  switch (form_.arithmetic) {
    case Arithmetic::float32:
      for (std::size_t i = 0; i < form_.size; ++i) {
        put(std::bit_cast<std::uint32_t>(exact(row)[i]), out.subspan(i * sizeof(float)));
      }
      return;
    case Arithmetic::int8:
      std::ranges::transform(small(row).first(form_.size), out.begin(),
                             [](std::int8_t value) { return static_cast<std::byte>(value); });
      return;
    case Arithmetic::sketch:
      for (std::size_t word = 0; word < words_; ++word) {
        put(sketches_[row * words_ + word], out.subspan(word * sizeof(std::uint64_t)));
      }
      return;
  }
}

bool DescriptorRows::can_be_saved(Arithmetic arithmetic,
                                  std::span<const std::byte> saved) noexcept {
  switch (arithmetic) {
    case Arithmetic::float32:
      for (; saved.size() >= sizeof(float); saved = saved.subspan(sizeof(float))) {
        if (!std::isfinite(std::bit_cast<float>(taken<std::uint32_t>(saved)))) return false;
      }
      return true;
    case Arithmetic::int8:
      return std::memchr(saved.data(), no_value, saved.size()) == nullptr;
    case Arithmetic::sketch:
      return true;
  }
  return false;
}

bool DescriptorRows::load(std::size_t row, std::span<const std::byte> saved) noexcept {
  if (saved.size() != saved_size() || !can_be_saved(form_.arithmetic, saved)) return false;
  switch (form_.arithmetic) {
    case Arithmetic::float32: {
      const std::span<float> values = exact_.subspan(row * stride_, form_.size);
      for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = std::bit_cast<float>(taken<std::uint32_t>(saved.subspan(i * sizeof(float))));
      }
      measure(row);
      return true;
    }
    case Arithmetic::int8: {
      const std::span<std::int8_t> bytes = small(row);
      std::memcpy(bytes.data(), saved.data(), saved.size());
      lengths_[row] = inverse_length(kernels_->dot(bytes.data(), bytes.data(), bytes.size()));
      return true;
    }
    case Arithmetic::sketch:
      for (std::size_t word = 0; word < words_; ++word) {
        sketches_[row * words_ + word] =
            taken<std::uint64_t>(saved.subspan(word * sizeof(std::uint64_t)));
      }
      copy_scanned(row);
      return true;
  }
  return false;
}

void DescriptorRows::copy(std::size_t row, const DescriptorRows& from,
                          std::size_t from_row) noexcept {
  const auto copy_row = [&](auto to, auto source, std::size_t size) {
    if (to.empty()) return;
    std::ranges::copy(source.subspan(from_row * size, size), to.subspan(row * size).begin());
  };
  copy_row(exact_, from.exact_, stride_);
  copy_row(small_, from.small_, stride_);
  copy_row(lengths_, from.lengths_, 1);
  copy_row(sketches_, from.sketches_, words_);
  copy_row(scanned_, from.scanned_, scanned_words);
}

void DescriptorRows::distances(std::span<const double> dots, double query_square, std::size_t first,
                               std::span<float> out) const noexcept {
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = euclidean(query_square, lengths_[first + i], dots[i]);
  }
}

void DescriptorRows::compare(const DescriptorRows& queries, std::size_t query, std::size_t first,
                             std::span<float> out) const noexcept {
  if (form_.difference != Difference::euclidean) {
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = mean_absolute(queries.exact(query), exact(first + i), form_.size);
    }
    return;
  }
  std::array<double, abreast> dots;
  in_pieces(out.size(), abreast, [&](std::size_t begin, std::size_t count) {
    float_kernels_->dots(queries.exact(query).data(), exact(first + begin).data(), stride_, count,
                         dots.data());
    distances(dots, queries.lengths_[query], first + begin, out.subspan(begin, count));
  });
}

void DescriptorRows::compare(const DescriptorRows& queries, std::size_t query, std::size_t first,
                             std::span<std::uint16_t> out) const noexcept {
  if (form_.arithmetic == Arithmetic::sketch) {
    std::array<std::uint32_t, abreast> bits;
    in_pieces(out.size(), abreast, [&](std::size_t begin, std::size_t count) {
      kernels_->hamming_column(&queries.sketches_[query * words_],
                               &sketches_[(first + begin) * words_], words_, count, bits.data());
      std::ranges::transform(std::span(bits).first(count), out.subspan(begin).begin(),
                             [](std::uint32_t b) { return static_cast<std::uint16_t>(b); });
    });
    return;
  }
  std::array<std::int32_t, abreast> dots;
  in_pieces(out.size(), abreast, [&](std::size_t begin, std::size_t count) {
    const std::size_t row = first + begin;
    kernels_->dot_column(queries.small(query).data(), small(row).data(), stride_, count,
                         dots.data());
    fixed_distances(std::span(dots).first(count), queries.lengths_[query],
                    lengths_.subspan(row, count), out.subspan(begin, count));
  });
}

void DescriptorRows::compare(const DescriptorRows& queries, std::size_t query,
                             std::span<const std::span<float>> out) const noexcept {
  std::array<double, MatcherConfig::most_frames_at_once * block_abreast> dots;
  in_blocks(queries.lengths_.size(), query, out, [&](const auto& block) {
    float_kernels_->dots_block(queries.exact(block.query).data(), block.columns.size(),
                               exact(block.row).data(), stride_, block.count, dots.data(),
                               block_abreast);
    for (std::size_t q = 0; q < block.columns.size(); ++q) {
      distances(std::span(dots).subspan(q * block_abreast), queries.lengths_[block.query + q],
                block.row, block.columns[q].subspan(block.row, block.count));
    }
  });
}

void DescriptorRows::compare(const DescriptorRows& queries, std::size_t query,
                             std::span<const std::span<std::uint16_t>> out) const noexcept {
  std::array<std::int32_t, MatcherConfig::most_frames_at_once * block_abreast> dots;
  in_blocks(queries.lengths_.size(), query, out, [&](const auto& block) {
    kernels_->dot_block(queries.small(block.query).data(), block.columns.size(),
                        small(block.row).data(), stride_, block.count, dots.data(), block_abreast);
    for (std::size_t q = 0; q < block.columns.size(); ++q) {
      fixed_distances(std::span(dots).subspan(q * block_abreast, block.count),
                      queries.lengths_[block.query + q], lengths_.subspan(block.row, block.count),
                      block.columns[q].subspan(block.row, block.count));
    }
  });
}

double DescriptorRows::difference(const DescriptorRows& queries, std::size_t query,
                                  std::size_t row) const noexcept {
  if (form_.arithmetic == Arithmetic::float32) {
    float found = 0.0F;
    compare(queries, query, row, std::span(&found, 1));
    return static_cast<double>(found);
  }
  std::uint16_t found = 0;
  compare(queries, query, row, std::span(&found, 1));
  return found / form_.unit();
}

void DescriptorRows::scan(const DescriptorRows& queries, std::size_t query, std::size_t first,
                          std::span<std::uint32_t> out) const noexcept {
  if (out.empty()) return;
  kernels_->hamming_column(&queries.scanned_[query * scanned_words],
                           &scanned_[first * scanned_words], scanned_words, out.size(), out.data());
}

void DescriptorRows::prefetch_sketches(std::size_t first, std::size_t count) const noexcept {
  constexpr std::size_t line = stored_line / sizeof(std::uint64_t);
  for (std::size_t word = first * words_; word < (first + count) * words_; word += line) {
    __builtin_prefetch(&sketches_[word]);
  }
}

void DescriptorRows::restore(std::size_t row, std::span<float> out) const noexcept {
  for (std::size_t i = 0; i < out.size(); ++i) {
    switch (form_.arithmetic) {
      case Arithmetic::float32:
        out[i] = exact(row)[i];
        break;
      case Arithmetic::int8:
        out[i] = static_cast<float>(small(row)[i] * lengths_[row]);
        break;
      case Arithmetic::sketch: {
        const std::uint64_t bits = sketches_[row * words_ + i / 64];
        const auto length = static_cast<float>(1.0 / std::sqrt(sketch_bits));
        out[i] = ((bits >> (i % 64)) & 1U) != 0 ? length : -length;
        break;
      }
    }
  }
}

std::size_t DescriptorRows::restored_size() const noexcept {
  return form_.arithmetic == Arithmetic::sketch ? 64 * sketch_words : padded_size(form_.size);
}

}  // namespace seqloop
