// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

namespace seqloop {

/// What a set of training pictures has in common: their mean, and the directions in which they vary
/// most; and pictures without those directions (Change Removal). A library of its own: link
/// `seqloop::principal_components`, or seqloop_principal_components before seqloop_core.
class PrincipalComponents {
 public:
  static constexpr std::size_t most_pictures = 1'000;

  /// Learns through the N x N products of the pictures, N being much smaller than P.
  /// @param pictures   [N, P] bytes, a picture a row, N from 1 to most_pictures
  /// @param size       P, values in a picture, at least 1
  /// @param components m, from 0 to N - 1
  /// @param between    called before each 1,024 values of the pictures; what it throws ends the
  ///   learning
  /// Errors: SetupError, all faults at once.
  /// Work: N N P / 2 + m N P MACs, and some 10 N N N for the eigenvectors.
  /// Allocates: 4 (m + 1) P bytes that stay; while learning some 24 N N + 8 (m + 1024) N more.
  PrincipalComponents(std::span<const std::uint8_t> pictures, std::size_t size,
                      std::size_t components, const std::function<void()>& between = {});

  [[nodiscard]] std::size_t size() const noexcept { return size_; }  // P

  /// Components found: fewer than asked for when the pictures vary in fewer directions.
  [[nodiscard]] std::size_t count() const noexcept { return coefficients_.size(); }

  /// @return [P]
  [[nodiscard]] std::span<const float> mean() const noexcept { return row(0); }

  /// @param index 0 .. count() - 1, the largest variance first
  /// @return [P] of unit length, each at right angles to the others; its sign means nothing
  [[nodiscard]] std::span<const float> component(std::size_t index) const noexcept {
    return row(index + 1);
  }

  /// x - U U^T (x - mean), rounded to the nearest byte within 0 .. 255. Without components the
  /// picture stays as it is.
  /// @param picture [P] read   @param out [P] written; may be the same memory
  /// Work: 2 P count() MACs. Allocates: never.
  void remove(std::span<const std::uint8_t> picture, std::span<std::uint8_t> out) noexcept;

 private:
  [[nodiscard]] std::span<const float> row(std::size_t index) const noexcept {
    return std::span(rows_).subspan(index * stride_, size_);
  }

  std::size_t size_;
  std::size_t stride_;                // P rounded up to a whole number of tiles
  std::vector<float> rows_;           // [1 + count, stride]: mean, then components, zero beyond P
  std::vector<double> coefficients_;  // [count], U^T (x - mean) of the picture at hand
};

}  // namespace seqloop
