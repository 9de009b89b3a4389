// SPDX-License-Identifier: MIT
// The legs of a drive that closes loops.
#include <algorithm>
#include <cmath>

#include "math.hpp"
#include "truth.hpp"

namespace seqloop::street {
namespace {

constexpr double kShortestVisit = 30.0;           // metres
constexpr double kShortestNew = 2 * Path::kBend;  // metres; both of its ends may bend

/// A stretch that may be visited again, and when it was new.
struct Stretch {
  double start, end;  // street metres
  double path;        // path metre of its start
};

double misfit(const Street& street, double heading, double s) {
  return std::fabs(wrap_angle(street.heading(s) - heading));
}

/// A part of some earlier stretch that is old enough at path metre `now` and begins about in the
/// direction of `heading`; length 0 if there is none.
Leg pick_visit(Dice& dice, const Street& street, const std::vector<Stretch>& known, double now,
               double age, double wanted, double heading) {
  Leg best;
  double least = 1e9;
  for (int attempt = 0; attempt < 24; ++attempt) {
    // The oldest stretch is seen oftener than the others, so some places are seen a third time.
    const auto count = static_cast<int>(std::min<std::size_t>(known.size(), 1'000'000));
    const auto i = static_cast<std::size_t>(dice.chance(0.35) ? 0 : dice.below(count));
    const Stretch& s = known[i];
    const double room = std::min(s.end - s.start, now - age - s.path);
    const double size = std::min(wanted, s.end - s.start);
    if (room < 0.0 || size < kShortestVisit) continue;
    const double start = s.start + std::min(s.end - s.start - size, room) * dice.range(0.0, 1.0);
    const double miss = misfit(street, heading, start);
    if (miss >= least) continue;
    least = miss;
    best = {start, size, false, true};
  }
  return best;
}

/// The street metre after `from` whose heading fits best, so that a visit runs on without a kink.
double pick_unseen(const Street& street, double from, double heading) {
  double best = from;
  for (double s = from; s < from + 420.0; s += 6.0) {
    if (misfit(street, heading, s) < misfit(street, heading, best)) best = s;
  }
  return best;
}

}  // namespace

std::vector<Leg> loop_legs(const Street& street, std::size_t frames, double length,
                           std::size_t kidnaps) {
  if (frames < 260 || length < 260.0) return {{0.0, length, true, false}};
  Dice dice(hash_of(street.seed(), 0x6c6f6f70));
  const double step = length / static_cast<double>(frames);
  const double age = 1.15 * static_cast<double>(kLoopAge) * step;
  const double scale = std::min(length, 1500.0 * step);
  std::vector<Leg> legs{{0.0, std::max(0.3 * scale, age + 10.0), true, false}};
  std::vector<Stretch> known{{2.0, legs[0].length - Path::kBend - 2.0, 2.0}};
  double now = legs[0].length;
  double unseen = now + 400.0;  // street metre from which nothing was seen yet
  while (length - now >= kShortestVisit) {
    const double wanted = std::max(kShortestVisit, scale * dice.range(0.09, 0.22));
    const double heading = street.heading(legs.back().start + legs.back().length);
    const Leg visit =
        pick_visit(dice, street, known, now, age, std::min(wanted, length - now), heading);
    if (visit.length > 0.0) {
      legs.push_back(visit);
      now += visit.length;
    }
    double fresh = std::max(kShortestNew, scale * dice.range(0.06, 0.14));
    // What is left must hold a whole visit, or else belongs to the last leg.
    if (length - now - fresh < kShortestVisit) fresh = length - now;
    if (fresh < 1.0) break;
    if (visit.length > 0.0) {
      unseen = pick_unseen(street, unseen, street.heading(visit.start + visit.length));
      legs.push_back({unseen, fresh, true, true});
      known.push_back(
          {unseen + Path::kBend, unseen + fresh - Path::kBend - 2.0, now + Path::kBend});
      unseen += fresh + 400.0;
    } else {
      legs.back().length += fresh;
      unseen = std::max(unseen, legs.back().start + legs.back().length + 400.0);
    }
    now += fresh;
  }
  legs.back().length += length - now;
  // Jumps are spread evenly over the visits.
  std::vector<std::size_t> visits;
  for (std::size_t k = 0; k < legs.size(); ++k) {
    if (!legs[k].fresh) visits.push_back(k);
  }
  const std::size_t jumps = std::min(kidnaps, visits.size());
  for (std::size_t i = 0; i < jumps; ++i) {
    legs[visits[(2 * i + 1) * visits.size() / (2 * jumps)]].joined = false;
  }
  return legs;
}

std::size_t count_kidnaps(const std::vector<Leg>& legs) {
  std::size_t count = 0;
  for (std::size_t k = 1; k < legs.size(); ++k) count += legs[k].joined ? 0U : 1U;
  return count;
}

}  // namespace seqloop::street
