// SPDX-License-Identifier: MIT
#include "seqloop/principal_components.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "seqloop/fault.hpp"

namespace seqloop {
namespace {

using Eigen::Index;

/// A step goes through a picture in pieces of this many values, so that it needs no memory.
constexpr std::size_t tile = 256;
using Tile = Eigen::Array<float, static_cast<int>(tile), 1>;
using TileView = Eigen::Map<const Tile>;

/// Learning goes through all pictures in pieces of this many values.
constexpr Index block = 1024;

/// [N, P]
using Pictures =
    Eigen::Map<const Eigen::Matrix<std::uint8_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

void check(std::size_t bytes, std::size_t size, std::size_t components) {
  Faults faults;
  if (size == 0 || bytes % size != 0) {
    throw SetupError(Fault{"training pictures", "they are not all of the same size"});
  }
  const std::size_t pictures = bytes / size;
  if (pictures > PrincipalComponents::most_pictures) {
    faults.push_back({"training pictures",
                      std::to_string(pictures) + " are more than " +
                          std::to_string(PrincipalComponents::most_pictures),
                      "train on fewer"});
  }
  if (components >= pictures) {
    faults.push_back({"components",
                      std::to_string(components) + " cannot be learned from " +
                          std::to_string(pictures) + " training pictures",
                      "ask for at least one component fewer than there are pictures"});
  }
  if (!faults.empty()) throw SetupError(std::move(faults));
}

/// Products of all pictures with each other, 128 subtracted: that moves the mean only, and of
/// numbers up to 128 a whole block of products (128^2 * 1024 = 2^24) is exact in float, so that
/// the order of the sums makes no difference.
Eigen::MatrixXd products_of(const Pictures& pictures, const std::function<void()>& between) {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(pictures.rows(), pictures.rows());
  Eigen::MatrixXf values(pictures.rows(), block);
  Eigen::MatrixXf products(pictures.rows(), pictures.rows());
  for (Index first = 0; first < pictures.cols(); first += block) {
    if (between) between();
    const Index width = std::min(block, pictures.cols() - first);
    auto part = values.leftCols(width);
    part = pictures.middleCols(first, width).cast<float>().array() - 128.0F;
    products.setZero();
    products.selfadjointView<Eigen::Lower>().rankUpdate(part);
    sum += products.cast<double>();
  }
  sum.triangularView<Eigen::StrictlyUpper>() = sum.transpose();
  return sum;
}

/// What the products would be had the pictures' mean been subtracted first.
void centre(Eigen::MatrixXd& products) {
  const Eigen::VectorXd means = products.rowwise().mean();
  const double mean = means.mean();
  products.colwise() -= means;
  products.rowwise() -= means.transpose();
  products.array() += mean;
}

/// @return [N, found]: each column makes a unit component of centred pictures, the largest variance
///   first
Eigen::MatrixXd weights_of(const Pictures& pictures, std::size_t components,
                           const std::function<void()>& between) {
  // Of the sum of all squares; rounding makes up to about 1e-13 of it.
  constexpr double vanishing = 1e-12;
  if (components == 0) return {};
  Eigen::MatrixXd products = products_of(pictures, between);
  const double least = vanishing * products.trace();
  centre(products);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(products);
  const Eigen::VectorXd values = solver.eigenvalues().reverse();
  Index found = 0;
  while (found < static_cast<Index>(components) && values[found] > least) ++found;
  return solver.eigenvectors().rowwise().reverse().leftCols(found) *
         values.head(found).cwiseSqrt().cwiseInverse().asDiagonal();
}

Tile load(std::span<const std::uint8_t> values, std::size_t first) noexcept {
  Tile loaded = Tile::Zero();
  const std::size_t count = std::min(tile, values.size() - first);
  for (std::size_t i = 0; i < count; ++i)
    loaded[static_cast<Index>(i)] = static_cast<float>(values[first + i]);
  return loaded;
}

}  // namespace

PrincipalComponents::PrincipalComponents(std::span<const std::uint8_t> pictures, std::size_t size,
                                         std::size_t components,
                                         const std::function<void()>& between)
    : size_(size), stride_((size + tile - 1) / tile * tile) {
  check(pictures.size(), size, components);
  const Pictures all(pictures.data(), static_cast<Index>(pictures.size() / size),
                     static_cast<Index>(size));
  const Eigen::MatrixXd weights = weights_of(all, components, between);
  coefficients_.resize(static_cast<std::size_t>(weights.cols()));
  rows_.resize((1 + count()) * stride_);
  Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> rows(
      rows_.data(), weights.cols() + 1, static_cast<Index>(stride_));
  for (Index first = 0; first < all.cols(); first += block) {
    if (between) between();
    const Index width = std::min(block, all.cols() - first);
    Eigen::MatrixXd part = all.middleCols(first, width).cast<double>();
    const Eigen::RowVectorXd mean = part.colwise().mean();
    part.rowwise() -= mean;
    auto columns = rows.middleCols(first, width);
    columns.row(0) = mean.cast<float>();
    if (count() > 0) {
      columns.bottomRows(weights.cols()) = (weights.transpose() * part).cast<float>();
    }
  }
}

void PrincipalComponents::remove(std::span<const std::uint8_t> picture,
                                 std::span<std::uint8_t> out) noexcept {
  std::ranges::fill(coefficients_, 0.0);
  for (std::size_t first = 0; first < size_; first += tile) {
    const float* mean = rows_.data() + first;
    const Tile centred = load(picture, first) - TileView(mean);
    for (std::size_t k = 0; k < count(); ++k) {
      const TileView component(mean + (k + 1) * stride_);
      coefficients_[k] += static_cast<double>((centred * component).sum());
    }
  }
  for (std::size_t first = 0; first < size_; first += tile) {
    Tile rest = load(picture, first);
    for (std::size_t k = 0; k < count(); ++k) {
      const TileView component(rows_.data() + (k + 1) * stride_ + first);
      rest -= static_cast<float>(coefficients_[k]) * component;
    }
    rest = rest.max(0.0F).min(255.0F) + 0.5F;
    const std::size_t values = std::min(tile, size_ - first);
    for (std::size_t i = 0; i < values; ++i)
      out[first + i] = static_cast<std::uint8_t>(rest[static_cast<Index>(i)]);
  }
}

}  // namespace seqloop
