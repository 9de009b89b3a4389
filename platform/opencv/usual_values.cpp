// SPDX-License-Identifier: MIT
#include <array>
#include <cstddef>
#include <cstdint>

#include "opencv/detail/oriented_gradients.hpp"
#include "opencv/detail/usual_values.hpp"
#include "seqloop/opencv/builtin_describer.hpp"

namespace seqloop::opencv {
namespace {

struct Statistics {
  std::array<double, usual_means.size()> mean{};
  std::array<double, usual_means.size()> variance{};
};

constexpr Statistics usual = [] {
  Statistics made;
  for (std::size_t d = 0; d < usual_means.size(); ++d) {
    const double mean = usual_unit * usual_means[d];
    made.mean[d] = mean;
    made.variance[d] = usual_deviation * mean * usual_deviation * mean;
  }
  return made;
}();

// As much as a drive may start from (`Standardisation::prior_frames`), whatever that is.
constexpr std::uint64_t many_frames = 1'000'000;

}  // namespace

bool expect_builtin(PlaceMap& map) noexcept {
  if (map.size() > 0 || map.statistics().frames() > 0) return false;
  return map.set_statistics(usual.mean, usual.variance, many_frames) &&
         map.set_columns(OrientedGradients::grid_columns);
}

}  // namespace seqloop::opencv
