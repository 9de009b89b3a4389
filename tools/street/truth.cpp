// SPDX-License-Identifier: MIT
#include "truth.hpp"

#include <algorithm>
#include <cmath>

namespace seqloop::street {
namespace {

/// Frame of [first, last) nearest to path metre p, the middle one of equals.
std::size_t nearest(const Drive& drive, std::size_t first, std::size_t last, double p) {
  const auto before = [&](std::size_t lo, std::size_t hi, double value, bool above) {
    while (lo < hi) {
      const std::size_t middle = lo + (hi - lo) / 2;
      const double at = drive.position(middle);
      if (at < value || (above && at <= value)) {
        lo = middle + 1;
      } else {
        hi = middle;
      }
    }
    return lo;
  };
  std::size_t i = before(first, last, p, false);
  if (i == last || (i > first && p - drive.position(i - 1) < drive.position(i) - p)) --i;
  const double at = drive.position(i);
  const std::size_t begin = before(first, last, at, false);
  const std::size_t end = before(first, last, at, true);
  return begin + (end - 1 - begin) / 2;
}

}  // namespace

std::vector<TruthRow> localise_truth(const Drive& query, const Drive& reference) {
  std::vector<TruthRow> rows;
  rows.reserve(query.frames());
  const double shift = query.path().legs()[0].start - reference.path().legs()[0].start;
  for (std::size_t i = 0; i < query.frames(); ++i) {
    rows.push_back({i, nearest(reference, 0, reference.frames(), query.position(i) + shift)});
  }
  return rows;
}

std::vector<TruthRow> loop_truth(const Drive& drive) {
  const Path& path = drive.path();
  const std::size_t legs = path.legs().size();
  std::vector<std::size_t> first(legs + 1, drive.frames());
  for (std::size_t i = drive.frames(); i-- > 0;) first[drive.leg(i)] = i;
  for (std::size_t k = legs; k-- > 0;) first[k] = std::min(first[k], first[k + 1]);
  std::vector<TruthRow> rows;
  for (std::size_t k = 0; k < legs; ++k) {
    if (path.legs()[k].fresh) continue;
    for (std::size_t i = first[k]; i < first[k + 1]; ++i) {
      const double s = drive.street(i);
      for (std::size_t j = 0; j < k && i > kLoopAge; ++j) {
        const Leg& earlier = path.legs()[j];
        if (s < earlier.start || s > earlier.start + earlier.length) continue;
        if (first[j] == first[j + 1]) continue;
        const double p = path.begin(j) + (s - earlier.start);
        const std::size_t r = nearest(drive, first[j], first[j + 1], p);
        // Beyond an end of the earlier visit nothing is near.
        if (std::fabs(drive.position(r) - p) > 2.0 || i - r <= kLoopAge) continue;
        rows.push_back({i, r});
      }
    }
  }
  return rows;
}

}  // namespace seqloop::street
