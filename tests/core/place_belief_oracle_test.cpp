// SPDX-License-Identifier: MIT
// The belief against the same filter written down anew from src/README.md, sections 6.1 to 6.4,
// without thought of speed: rows in a tree, the C library's functions, no rows kept sorted.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

#include "core/matcher.hpp"
#include "core/seen.hpp"
#include "core/ways.hpp"
#include "seqloop/detail/sketch.hpp"

namespace seqloop {
namespace {

constexpr std::size_t size = 128;

/// Section 6, step by step.
class NaiveBelief {
 public:
  /// @param earlier_drives whether the map has places of some
  /// @param localises whether this one is not added to them
  /// @param jumps as `PlaceBelief::observe` has it
  NaiveBelief(bool earlier_drives, bool localises, double jumps)
      : earlier_drives_(earlier_drives), localises_(localises), jumps_(jumps) {}

  struct Row {
    double mass = 0.0, gain = 0.0, wrong = 0.0, clear = 0.0, age = 0.0, doubt = 0.0, pace = 1.0;
    double usual = 2.0;  // decaying mean of l
    double past = -10.0;
    double in_step = 0.0, step = 0.0;  // decaying mean, and the newest; NaN: nothing is known
    double alike = 0.0;                // decaying mean
    std::vector<std::size_t> way;      // rows that it came through, the newest last
  };

  /// @param remembered of the evidence: log-odds
  void observe(const SceneView& view, const auto& remembered) {
    const auto share = [&](std::size_t frame, std::size_t row) {
      return view.map->rows().look_closely(view.queries->rows(), view.queries->row_of(frame),
                                           view.map->order().slot(row)) /
             1024.0;
    };
    const auto of_frames = [&](std::size_t a, std::size_t b) {
      const DescriptorRows& rows = view.queries->rows();
      return rows.look_closely(rows, view.queries->row_of(a), view.queries->row_of(b)) / 1024.0;
    };
    const auto t = static_cast<std::size_t>(view.newest);
    places_ = view.map->size();
    // 6.1
    std::vector<double> shares;
    for (const std::uint32_t bits : view.seen->scanned()) shares.push_back(bits / 256.0);
    const auto n = static_cast<double>(shares.size());
    double mu = 0.0;
    for (const double s : shares) mu += s / n;
    double s2 = 0.0;
    for (const double s : shares) s2 += (s - mu) * (s - mu) / n;
    const auto noise = [&](double bits) { return mu * (1.0 - mu) / bits; };
    const double spread = std::max(s2 - noise(256), 0.012 * 0.012);
    const double sigma = std::sqrt(spread + noise(1024));
    double mean = 0.0;
    for (const double s : shares) {
      mean += std::exp((mu - s) / std::sqrt(spread + noise(256))) / n;
    }
    const double bias = std::log(mean) + 0.55;
    // 6.2
    double change = std::pow(0.5, 0.7);
    double w = change;
    if (t > 0) {
      const auto d2 = [&](std::size_t k) { return std::pow(chord(of_frames(t - k, t)), 2); };
      const double c = std::max(0.0, 1.0 - d2(1) / 2.0);
      const double far = std::pow(chord(mu), 2);
      double gone = 1.0;
      if (d2(1) <= 0.9 * far) {
        gone = std::clamp((d2(std::min<std::size_t>(20, t)) - d2(1)) / (0.5 * (far - d2(1))), 0.0,
                          1.0);
      }
      change = std::pow(std::min(0.5, std::max(0.0, 1.0 - c - 0.03) / (1.0 + c)), 0.7);
      w = change * gone;
    }
    // 6.3, move
    const auto chances = [&](std::size_t row, double pace) -> std::vector<double> {
      if (w <= 0.02) return {0.45, 0.40, 0.15};
      const bool of_this_drive = row >= view.map->order().newest_session().first;
      const bool near_one = pace >= (of_this_drive ? 0.65 : 0.85) && pace <= 1.35;
      if (jumps_ > 0.01 || (!localises_ && near_one)) return {0.06, 0.88, 0.06};
      // Those of one that stays, or goes by two, get more, the further its pace is from one.
      const double off = std::abs(pace - 1.0);
      const double other = 0.06 + 0.86 * off;
      const double same = 0.88 - 0.82 * off;
      const double least = 0.06 - 0.04 * off;
      return pace < 1.0 ? std::vector{other, same, least} : std::vector{least, same, other};
    };
    std::map<std::size_t, Row> moved;
    const double ended = gone_on(view.map->size(), chances, w > 0.02, moved);
    // 6.3, what comes
    const bool begins = weighed_++ < 20;
    const double coming = std::max(begins && earlier_drives_ ? 0.1 : 0.001, std::min(0.1, jumps_)) *
                          std::min(1.0, static_cast<double>(view.rows) / 200.0);
    const double born = coming * std::min(1.0, 4.0 * w) * new_place;
    if (!earlier_drives_) {
      std::erase_if(moved, [&](const auto& at) { return at.second.mass < born / n; });
    }
    keep_48(moved);
    // Leave and come.
    double on = ended;
    for (auto& [row, at] : moved) {
      on += at.mass;
      at.mass *= 1.0 - 0.01 * w;
    }
    new_place += 0.01 * w * on - born;
    for (const auto& found : view.seen->found()) {
      if (born <= 0.0) break;
      Row& at = moved[found.row];
      const double old = at.mass / (at.mass + born / n);
      at.mass += born / n;
      for (double* const sum : {&at.gain, &at.wrong, &at.clear, &at.age}) *sum *= old;
    }
    // Weigh.
    std::map<std::size_t, double> gains;
    for (auto& [row, at] : moved) {
      const double here = share(t, row);
      double contrast = 0.0;
      if (t >= 8) {
        double around = 2.0 * share(t - 8, row);
        double weight = 2.0;
        for (const std::size_t other : {row - 8, row + 8}) {
          if (other >= view.map->size()) continue;
          around += share(t, other);
          weight += 1.0;
        }
        contrast = (around / weight - here) / sigma;
      }
      const double l = std::clamp((mu - here) / sigma + 0.7 * contrast - bias, -1.5, 3.0);
      gains[row] = l;
      at.way.push_back(row);
      at.mass *= std::exp(w * l);
      at.gain = kept(w) * at.gain + w * l;
      at.clear = 0.95 * at.clear + 0.05 * contrast;
      at.step = std::numeric_limits<double>::quiet_NaN();
      if (t >= 8 && at.way.size() > 8) {
        const std::size_t from = at.way[at.way.size() - 9];
        if (from + 2 <= row && row <= from + 16 && mu > 0.0) {
          const auto c = [&](std::size_t there, std::size_t frame) {
            return std::pow(chord(share(frame, there)), 2);
          };
          const double far = std::pow(chord(mu), 2);
          const double way = std::max(std::pow(chord(of_frames(t - 8, t)), 2), 0.3 * far);
          const double together = c(row, t) + c(from, t - 8);
          const double alike = std::max(0.0, 1.0 - together / (2.0 * far));
          at.step = (c(row, t - 8) + c(from, t) - together) / (2.0 * way) - 0.4 * alike -
                    std::min(0.06, 0.25 * alike);
          at.in_step = 0.95 * at.in_step + 0.05 * at.step;
        }
      }
      const double alike = mu > 0.0 ? 1.0 - std::pow(chord(here) / chord(mu), 2) : 0.0;
      at.alike = at.way.size() == 1 ? alike : 0.95 * at.alike + 0.05 * alike;
      at.age += w;
      at.doubt = std::max(0.0, (1.0 - 0.015 * w) * at.doubt +
                                   change * (std::clamp(0.75 * at.usual, 0.0, 1.25) - l));
      at.usual += 0.02 * w * (l - at.usual);
    }
    // Sharpen.
    const auto sharp = [&](std::size_t row) {
      return moved[row].mass * std::exp(0.2 * (1.0 - w) * gains[row]);
    };
    rows_ = moved;
    double sum = new_place;
    for (auto& [row, at] : rows_) {
      double before = 0.0;
      double after = 0.0;
      for (const auto& [other, there] : moved) {
        if (other + 5 < row || other > row + 5) continue;
        before += there.mass;
        after += sharp(other);
      }
      at.mass = sharp(row) * before / after;
      sum += at.mass;
    }
    for (auto& [row, at] : rows_) at.mass /= sum;
    new_place /= sum;
    judge(w, gains);
    if (rows_.empty()) return;
    // 6.4, `best`
    const double here = remembered(evidence);
    double& past = rows_.at(likeliest).past;
    if (localises_ ? new_place > 0.5 : evidence.doubt > 3.0) {
      for (auto& [row, at] : rows_) at.past = std::min(at.past, here);
    }
    past = std::max(past, here);
    best = past;
  }

  /// A frame that shows nothing.
  /// @param is_step whether it is one of its own, or one with the newest
  void drift(std::size_t rows, bool is_step) {
    const auto chances = [rows](std::size_t row, double) -> std::vector<double> {
      if (row + 1 == rows) return {1.0};
      if (row + 2 == rows) return {0.45, 0.55};
      return {0.45, 0.40, 0.15};
    };
    std::map<std::size_t, Row> moved;
    gone_on(rows, chances, false, moved);
    rows_ = moved;
    keep_48(rows_);
    double sum = new_place;
    for (auto& [row, at] : rows_) {
      at.past = -10.0;
      if (is_step) at.way.push_back(row);
      at.way.back() = row;
      sum += at.mass;
    }
    for (auto& [row, at] : rows_) at.mass /= sum;
    new_place /= sum;
    if (is_step) showed_.push_back({none, none});
  }

  double new_place = 1.0;
  std::size_t likeliest = 0;
  double best = 0.0;  // on the likeliest row's way
  Row top_row;        // the likeliest one
  Evidence evidence;

 private:
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  /// 6.3, step 1
  /// @param chances by a row and its pace @param paced whether that follows @param moved filled
  /// @return what has gone beyond the last row, where no other visit is known
  double gone_on(std::size_t rows, const auto& chances, bool paced,
                 std::map<std::size_t, Row>& moved) const {
    std::map<std::size_t, double> largest;
    double ended = 0.0;
    for (const auto& [row, old] : rows_) {
      const std::vector<double> by = chances(row, old.pace);
      for (std::size_t i = 0; i < by.size(); ++i) {
        const double part = by[i] * old.mass;
        if (row + i >= rows) {
          ended += part;
          continue;
        }
        Row& here = moved[row + i];
        const double mass = here.mass + part;
        // Of equals the one that moved least.
        if (part > largest[row + i] || (part == largest[row + i] && part > 0.0)) {
          largest[row + i] = part;
          here = old;
          if (paced) here.pace = pace_after(old, static_cast<double>(i));
        }
        here.mass = mass;
      }
    }
    return ended;
  }

  static void keep_48(std::map<std::size_t, Row>& moved) {
    std::vector<std::pair<double, std::size_t>> order;
    for (const auto& [row, at] : moved) order.emplace_back(-at.mass, row);
    std::ranges::sort(order);
    for (std::size_t i = 48; i < order.size(); ++i) moved.erase(order[i].second);
  }

  /// 6.3, step 3
  static double kept(double w) { return std::max(0.95, 1.0 - 0.22 * w); }

  /// 6.3, step 1
  double pace_after(const Row& old, double by) const {
    const double quick = 0.9 * old.pace + 0.1 * by;
    if (localises_ || quick >= 1.0) return quick;
    return old.doubt > 2.0 && by < old.pace ? old.pace : 0.95 * old.pace + 0.05 * by;
  }

  /// What a frame showed of wrong rows.
  struct Showed {
    std::size_t row = 0, other = 0;  // the likeliest, and the best elsewhere
    double sum = 0.0, best = -2.0;   // their sums while wrong
    bool on_map = false;
    double novelty = 0.0;
    [[nodiscard]] double wrong() const { return std::max({-2.0, best, on_map ? -2.0 : sum}); }
  };

  /// 6.4
  void judge(double w, const std::map<std::size_t, double>& gains) {
    if (rows_.empty()) return;
    const auto top =
        std::ranges::max_element(rows_, {}, [](const auto& at) { return at.second.mass; });
    likeliest = top->first;
    const bool on_map = new_place <= 0.5;
    const auto same = [](std::size_t a, std::size_t b) { return a + 10 >= b && a <= b + 10; };
    double big = 0.0;
    Showed showed{likeliest, none, 0.0, -1e9, on_map, w};
    for (auto& [row, at] : rows_) {
      const bool here = same(row, likeliest);
      at.wrong = kept(w) * at.wrong + (here && on_map ? 0.0 : w * gains.at(row));
      if (here) {
        big += at.mass;
      } else if (at.wrong > showed.best) {
        showed.best = at.wrong;
        showed.other = row;
      }
    }
    showed.sum = top->second.wrong;
    showed_.push_back(showed);
    // What was shown 20 frames ago is known better now.
    const std::vector<std::size_t>& way = top->second.way;
    if (showed_.size() > 20 && on_map && way.size() > 20) {
      Showed& then = showed_[showed_.size() - 21];
      const std::size_t right = way[way.size() - 21];
      if (same(then.row, right)) {
        then.on_map = true;
      } else if (then.other != none && same(then.other, right)) {
        then.best = then.sum;
        then.on_map = true;
      }
    }
    // All frames anew.
    double mean = 0.0, variance = 1.0, weight = 0.0;
    for (const Showed& frame : showed_) {
      if (frame.novelty <= 0.02) continue;
      if (weight == 0.0) mean = frame.wrong();
      const double a = 1.0 / std::min(weight + 1.0, 300.0);
      weight += 2.0 * frame.novelty;
      const double off = frame.wrong() - mean;
      mean += a * off;
      variance = (1.0 - a) * (variance + a * off * off);
    }
    big = std::clamp(big, 1e-12, 1.0 - 1e-12);
    evidence.jumps = jumps_;
    evidence.odds = std::log(big / (1.0 - big));
    evidence.known = -std::log(1e-4 + new_place);
    evidence.lead = (top->second.gain - mean) / std::sqrt(variance + 1.25);
    top_row = top->second;
    evidence.contrast = top->second.clear;
    evidence.in_step = top->second.in_step;
    evidence.age = std::log(1.0 + top->second.age);
    evidence.doubt = top->second.doubt;
    const bool is_back_soon = !localises_ && !earlier_drives_ && places_ - top->first < 100;
    evidence.unlike = is_back_soon ? std::max(0.0, 0.45 - top->second.alike) : 0.0;
  }

  bool earlier_drives_;
  bool localises_;
  double jumps_;
  std::size_t places_ = 0;
  int weighed_ = 0;
  std::map<std::size_t, Row> rows_;
  std::vector<Showed> showed_;
};

/// What a map's places are, and whether the drive is added to them.
enum class Map : std::uint8_t { to_localise_in, of_earlier_drives, of_the_same_drive };

/// Frames of a query that show nothing: one that is a step, and one that is not.
const std::vector<float> unreadable;
const std::vector<float> hidden{0.0F};

void expect_like_the_naive_one(const oracle::Vectors& places, const oracle::Vectors& query,
                               Map kind = Map::to_localise_in, double jumps = 0.0,
                               std::uint64_t pattern = 5) {
  MatcherConfig config;
  config.use = kind == Map::to_localise_in ? Use::localise : Use::close_loops;
  config.standardisation.on = false;
  config.relocalising.rows_scanned = 150;
  Seen seen(places, config, kind == Map::of_earlier_drives ? places.size() : 0);
  PlaceBelief belief(seen.memory.arena, config);
  NaiveBelief naive(kind != Map::of_the_same_drive, kind == Map::to_localise_in, jumps);
  std::size_t judged = 0;
  std::size_t traced = 0;
  for (const auto& descriptor : query) {
    if (descriptor.size() != size) {
      const bool is_step = descriptor == unreadable;
      if (is_step) seen.queries.push_again();
      belief.drift(seen.map, is_step);
      naive.drift(seen.map.size(), is_step);
      ASSERT_NEAR(belief.new_place(), naive.new_place, 1e-9);
      continue;
    }
    const SceneView view = seen.take(descriptor);
    static_cast<void>(belief.observe(view, jumps));
    // So that the best is now of one row, now of another, and a good deal is known of rows before
    // a doubt makes it start anew, and little then. By none of what depends on which of two equal
    // rows it came through.
    const auto remembered = [&](Evidence evidence) {
      evidence.in_step = 0.0;
      const double favoured = evidence.doubt < 3.0 ? 6.0 : evidence.doubt < 4.0 ? -6.0 : 0.0;
      return log_odds(evidence) + static_cast<double>(view.newest * pattern % 13) - 6.0 + favoured;
    };
    naive.observe(view, remembered);
    SCOPED_TRACE("frame " + std::to_string(view.newest));
    ASSERT_NEAR(belief.new_place(), naive.new_place, 1e-9);
    if (!belief.likeliest()) continue;
    ++judged;
    const Evidence& e = belief.likeliest()->evidence;
    ASSERT_EQ(belief.likeliest()->row, naive.likeliest);
    ASSERT_EQ(e.jumps, naive.evidence.jumps);
    ASSERT_NEAR(e.odds, naive.evidence.odds, 1e-3);
    ASSERT_NEAR(e.known, naive.evidence.known, 1e-6);
    ASSERT_NEAR(e.lead, naive.evidence.lead, 1e-6);
    ASSERT_NEAR(e.contrast, naive.evidence.contrast, 1e-6);
    ASSERT_NEAR(e.age, naive.evidence.age, 1e-6);
    ASSERT_NEAR(e.doubt, naive.evidence.doubt, 1e-6);
    ASSERT_NEAR(e.unlike, naive.evidence.unlike, 1e-6);
    // Of two rows that a row comes from, and that are equal but for rounding, either may be taken.
    std::vector<BeliefTraces::Step> trace(PlaceBelief::depth(config));
    trace.resize(belief.trace(belief.likeliest()->index, trace));
    const std::vector<std::size_t>& way = naive.top_row.way;
    const auto same_row = [](const BeliefTraces::Step& step, std::size_t row) {
      return step.row == row;
    };
    if (trace.size() <= way.size() &&
        std::equal(trace.begin(), trace.end(), way.rbegin(), same_row)) {
      ++traced;
      ASSERT_NEAR(e.in_step, naive.evidence.in_step, 1e-3);
      ASSERT_EQ(std::isnan(trace.front().in_step), std::isnan(naive.top_row.step));
      if (!std::isnan(naive.top_row.step)) {
        ASSERT_NEAR(trace.front().in_step, naive.top_row.step, 1e-6);
      }
    }
    ASSERT_NEAR(belief.remember(remembered(e)), naive.best, 1e-3);
  }
  EXPECT_GT(judged, query.size() / 2);
  EXPECT_GT(traced, judged / 4);
}

TEST(PlaceBeliefOracle, OnAKnownWay) {
  // Rows that gain the least that counts are equal but for rounding: on the ways 2 and 3 that
  // decides which of them goes.
  for (const std::uint32_t seed : {1U, 4U, 5U, 6U}) {
    SCOPED_TRACE(seed);
    expect_like_the_naive_one(test::way(seed, 200, 0.5F, 1, size),
                              test::way(seed, 200, 0.5F, 2, size));
  }
}

TEST(PlaceBeliefOracle, AtHalfAndTwiceThePace) {
  // Without the ways on which rows are equal but for rounding: 2 to 4 of the first eight, more of
  // them after jumps, where more rows are found, and other ones with another processor's
  // logarithms.
  for (const auto& [seed, kind, jumps] : {std::tuple{1U, Map::to_localise_in, 0.0},
                                          {5U, Map::to_localise_in, 0.0},
                                          {19U, Map::to_localise_in, 0.02},
                                          {20U, Map::to_localise_in, 0.02},
                                          {22U, Map::to_localise_in, 0.02},
                                          {5U, Map::to_localise_in, 0.3},
                                          {1U, Map::of_earlier_drives, 0.0},
                                          {5U, Map::of_earlier_drives, 0.0},
                                          {7U, Map::of_earlier_drives, 0.0},
                                          {1U, Map::of_the_same_drive, 0.0},
                                          {4U, Map::of_the_same_drive, 0.0},
                                          {5U, Map::of_the_same_drive, 0.0}}) {
    SCOPED_TRACE(std::to_string(seed) + ", jumps " + std::to_string(jumps));
    const oracle::Vectors known = test::way(seed, 200, 0.5F, 1, size);
    const oracle::Vectors way = test::way(seed, 200, 0.5F, 2, size);
    const oracle::Vectors again = test::way(seed, 200, 0.5F, 3, size);
    oracle::Vectors slow;
    oracle::Vectors fast;
    for (std::size_t i = 0; i < 200; ++i) {
      slow.push_back((i % 2 == 0 ? way : again)[i / 2]);
      if (i % 2 == 0) fast.push_back(way[i]);
    }
    expect_like_the_naive_one(known, slow, kind, jumps);
    expect_like_the_naive_one(known, fast, kind, jumps);
  }
}

TEST(PlaceBeliefOracle, OnASmallMap) {
  expect_like_the_naive_one(test::way(1, 90, 0.5F, 1, size), test::way(1, 90, 0.5F, 2, size));
}

TEST(PlaceBeliefOracle, OnAWayOfTheSameDrive) {
  expect_like_the_naive_one(test::way(1, 200, 0.5F, 1, size), test::way(1, 200, 0.5F, 2, size),
                            Map::of_the_same_drive);
}

TEST(PlaceBeliefOracle, OnAWayThatIsAddedToEarlierDrives) {
  expect_like_the_naive_one(test::way(1, 200, 0.5F, 1, size), test::way(1, 200, 0.5F, 2, size),
                            Map::of_earlier_drives);
}

/// What was known of a way is forgotten where the robot leaves it, unless it localises.
TEST(PlaceBeliefOracle, OnAWayThatIsLeftAndComeBackTo) {
  const oracle::Vectors way = test::way(1, 200, 0.5F, 2, size);
  const oracle::Vectors other = test::way(3, 200, 0.5F, 1, size);
  for (const std::size_t away : {2U, 3U, 4U, 6U, 10U, 60U}) {
    oracle::Vectors query = way;
    for (std::size_t from = 40; from + away < 200; from += away + 23) {
      std::copy_n(other.begin() + static_cast<std::ptrdiff_t>(from), away,
                  query.begin() + static_cast<std::ptrdiff_t>(from));
    }
    for (const Map kind : {Map::to_localise_in, Map::of_earlier_drives, Map::of_the_same_drive}) {
      for (const std::uint64_t pattern : {3U, 5U, 7U}) {
        SCOPED_TRACE(std::to_string(away) + ", " + std::to_string(static_cast<int>(kind)) + ", " +
                     std::to_string(pattern));
        expect_like_the_naive_one(test::way(1, 200, 0.5F, 1, size), query, kind, 0.0, pattern);
      }
    }
  }
}

TEST(PlaceBeliefOracle, WhereFramesShowNothing) {
  for (const auto& nothing : {unreadable, hidden}) {
    for (const std::size_t frames : {1U, 4U, 12U}) {
      for (const Map kind : {Map::to_localise_in, Map::of_earlier_drives, Map::of_the_same_drive}) {
        SCOPED_TRACE(std::to_string(nothing.size()) + ", " + std::to_string(frames) + ", " +
                     std::to_string(static_cast<int>(kind)));
        oracle::Vectors query = test::way(1, 200, 0.5F, 2, size);
        for (const auto at : {60, 130, 187}) {
          if (nothing == unreadable) {
            std::fill_n(query.begin() + at, frames, nothing);
          } else {
            query.insert(query.begin() + at, frames, nothing);
          }
        }
        expect_like_the_naive_one(test::way(1, 200, 0.5F, 1, size), query, kind);
      }
    }
  }
}

/// Fewer are too few to be believed.
TEST(PlaceBeliefOracle, OfEarlierDrivesTwentyPlacesCount) {
  MatcherConfig config;
  config.use = Use::close_loops;
  config.standardisation.on = false;
  const oracle::Vectors way = test::way(1, 60, 0.5F, 1, size);
  const auto new_place = [&](std::size_t earlier) {
    Seen seen(way, config, earlier);
    PlaceBelief belief(seen.memory.arena, config);
    static_cast<void>(belief.observe(seen.take(way.front()), 0.0));
    return belief.new_place();
  };
  EXPECT_LT(new_place(20), new_place(19) - 0.003);
  EXPECT_EQ(new_place(19), new_place(0));
  EXPECT_EQ(new_place(20), new_place(40));
}

/// As a faster camera sees a way.
TEST(PlaceBeliefOracle, WhereAFrameTellsLittle) {
  // Without the ways on which rows are equal but for rounding: 7 of the first twelve.
  for (const std::uint32_t seed : {2U, 3U, 8U, 9U, 12U}) {
    for (const std::size_t frames : {5U, 8U}) {
      for (const Map kind : {Map::to_localise_in, Map::of_the_same_drive}) {
        SCOPED_TRACE(std::to_string(seed) + ", " + std::to_string(frames) + ", " +
                     std::to_string(static_cast<int>(kind)));
        expect_like_the_naive_one(test::slowly(test::way(seed, 40, 0.5F, 1, size), frames, 1),
                                  test::slowly(test::way(seed, 40, 0.5F, 2, size), frames, 2),
                                  kind);
      }
    }
  }
}

TEST(PlaceBeliefOracle, OnAnUnknownOne) {
  expect_like_the_naive_one(test::way(4, 200, 0.5F, 1, size), test::way(5, 200, 0.5F, 1, size));
}

TEST(PlaceBeliefOracle, WhereTheRobotStandsAndIsCarried) {
  const oracle::Vectors way = test::way(6, 300, 0.5F, 2, size);
  oracle::Vectors query(way.begin() + 20, way.begin() + 60);
  query.insert(query.end(), 30, query.back());
  query.insert(query.end(), way.begin() + 200, way.begin() + 260);
  expect_like_the_naive_one(test::way(6, 300, 0.5F, 1, size), query);
}

}  // namespace
}  // namespace seqloop
