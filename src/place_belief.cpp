// SPDX-License-Identifier: MIT
#include "seqloop/detail/place_belief.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <utility>

#include "seqloop/detail/portable_math.hpp"
#include "seqloop/detail/sketch.hpp"

namespace seqloop {
namespace {

// Fewer rows than that tell nothing of how unlike places usually are.
constexpr std::size_t least_rows = 20;

// Rows go on by 0, 1 or 2 a frame; a robot that stands may as well stay.
constexpr std::array<double, 3> moving{0.06, 0.88, 0.06};
constexpr std::array<double, 3> standing{0.45, 0.40, 0.15};
constexpr double least_novelty = 0.02;

// A frame is compared with those that lie so far off, too.
constexpr std::size_t apart = 8;

// Chances of a novel frame: to leave the map; to come back onto it.
constexpr double leaving = 0.01;
constexpr double coming = 0.001;

constexpr double decay = 0.95;
constexpr std::size_t born_most = 16;
constexpr std::size_t old_most = PlaceBelief::most - born_most;

constexpr double scanned_bits = DescriptorRows::scanned_words * 64.0;
constexpr double close_bits = DescriptorRows::close_words * 64.0;

constexpr std::uint32_t no_parent = PlaceBelief::most;

}  // namespace

double log_odds_now(const Evidence& e) noexcept {
  return -4.889 + 0.104 * e.odds + 0.889 * e.lead + 1.122 * e.contrast + 0.808 * e.age +
         8.814 * e.margin;
}

double log_odds(const Evidence& e) noexcept {
  return -4.4 + 0.204 * e.odds + 0.838 * e.lead + 1.795 * e.contrast + 0.498 * e.age +
         7.145 * e.margin + 0.216 * e.past;
}

double PlaceBelief::Level::lead(double value) const noexcept {
  return (value - mean) / std::sqrt(variance + 0.25);
}

PlaceBelief::PlaceBelief(Arena& arena, const MatcherConfig& config) : depth_(config.patience + 1) {
  const bool used = config.decision == Decision::probability;
  rows_ = arena.take<Hypothesis>("hypotheses", used ? most : 0);
  moved_ = arena.take<Hypothesis>("hypotheses that have moved", used ? 4 * most : 0);
  traces_ = arena.take<Traced>("traces of hypotheses", used ? depth_ * most : 0);
  histogram_ = arena.take<std::uint32_t>("histogram of a scan",
                                         used ? static_cast<std::size_t>(scanned_bits) + 1 : 0);
}

std::size_t PlaceBelief::observe(const View& view) noexcept {
  sketches_ = 0;
  likeliest_.reset();
  const std::optional<Scene> scene = look_around(view);
  if (!scene) {
    restart();
    return sketches_;
  }
  const double w = scene->novelty;
  move(view.map->order(), w > least_novelty ? moving : standing);
  double on = 0.0;
  for (std::size_t i = 0; i < moved_count_; ++i) on += moved_[i].mass;
  const double born = coming * std::min(1.0, 4.0 * w) * new_place_;
  for (std::size_t i = 0; i < moved_count_; ++i) moved_[i].mass *= 1.0 - leaving * w;
  new_place_ = new_place_ - born + leaving * w * on;
  give_birth(view, born / static_cast<double>(view.seen->scanned().bits.size()));
  weigh(view, *scene);
  judge(view, *scene);
  return sketches_;
}

/// How unlike the newest frame and the rows of the map usually are.
std::optional<PlaceBelief::Scene> PlaceBelief::look_around(const View& view) noexcept {
  const std::span<const std::uint32_t> bits = view.seen->scanned().bits;
  if (view.rows < least_rows || bits.size() < std::min(least_rows, view.rows)) return std::nullopt;
  std::ranges::fill(histogram_, 0U);
  for (const std::uint32_t b : bits) ++histogram_[b];
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t b = 0; b < histogram_.size(); ++b) {
    const double x = static_cast<double>(b) * static_cast<double>(histogram_[b]);
    sum += x;
    squares += x * static_cast<double>(b);
  }
  const auto n = static_cast<double>(bits.size());
  const double mean = sum / n / scanned_bits;
  const double variance = squares / n / (scanned_bits * scanned_bits) - mean * mean;
  // Few bits make the shares noisier than more of them will be.
  const double chance = mean * (1.0 - mean);
  constexpr double least_deviation = 0.012;
  const double spread =
      std::max(variance - chance / scanned_bits, least_deviation * least_deviation);
  const double scanned = std::sqrt(spread + chance / scanned_bits);
  // The mean of e^z, which from one count of bits to the next falls by the same share.
  const auto likest = static_cast<std::size_t>(std::distance(
      histogram_.begin(), std::ranges::find_if(histogram_, [](std::uint32_t c) { return c > 0; })));
  const double falls = exponential(-1.0 / (scanned_bits * scanned));
  double power = exponential((mean - static_cast<double>(likest) / scanned_bits) / scanned);
  constexpr double highest = 160'000.0;  // about e^12: a few rows alike are no sign of the rest
  double exponentials = 0.0;
  for (std::size_t b = likest; b < histogram_.size(); ++b) {
    exponentials += static_cast<double>(histogram_[b]) * std::min(power, highest);
    power *= falls;
  }
  constexpr double above = 0.55;
  return Scene{mean, std::sqrt(spread + chance / close_bits), logarithm(exponentials / n) + above,
               novelty(view, mean)};
}

/// How much the newest frame tells that those before it did not.
double PlaceBelief::novelty(const View& view, double mean) noexcept {
  const std::uint64_t frames = view.newest - view.oldest;
  if (frames == 0) return 0.0;
  const DescriptorRows& queries = view.queries->rows();
  const auto squared = [&](std::size_t back) {
    ++sketches_;
    const double d = chord(queries.look_closely(queries, view.queries->row_of(view.newest),
                                                view.queries->row_of(view.newest - back)) /
                           close_bits);
    return d * d;
  };
  const double before = squared(1);
  const double cosine = std::max(0.0, 1.0 - before / 2.0);
  constexpr double noise = 0.03;
  constexpr double power = 0.7;
  constexpr double highest = 0.5;
  const double change = std::min(highest, std::max(0.0, 1.0 - cosine - noise) / (1.0 + cosine));
  if (change <= 0.0) return 0.0;
  // A camera that shakes, or noise, changes much from frame to frame and goes nowhere.
  const double mu = chord(mean) * chord(mean);
  double gone = 1.0;
  if (before <= 0.9 * mu) {
    const double earlier =
        squared(static_cast<std::size_t>(std::min<std::uint64_t>(reach, frames)));
    gone = std::clamp((earlier - before) / (0.5 * (mu - before)), 0.0, 1.0);
  }
  return exponential(power * logarithm(change)) * gone;
}

/// Moves the belief on by a frame: each row now comes from its likeliest predecessor. What would
/// leave its session is gone.
void PlaceBelief::move(const PlaceOrder& order, std::span<const double> kernel) noexcept {
  moved_count_ = 0;
  std::array<std::size_t, 3> next{};
  while (true) {
    std::size_t row = static_cast<std::size_t>(-1);
    for (std::size_t by = 0; by < kernel.size(); ++by) {
      if (next[by] < count_) row = std::min(row, rows_[next[by]].row + by);
    }
    if (row == static_cast<std::size_t>(-1)) break;
    Hypothesis moved;
    double best = 0.0;
    double mass = 0.0;
    bool reached = false;
    for (std::size_t by = 0; by < kernel.size(); ++by) {
      if (next[by] == count_ || rows_[next[by]].row + by != row) continue;
      const std::size_t from = next[by]++;
      if (order.apart(rows_[from].row, row) != by) continue;
      reached = true;
      const double part = kernel[by] * rows_[from].mass;
      if (part > best) {
        best = part;
        moved = rows_[from];
        moved.parent = static_cast<std::uint32_t>(from);
      }
      mass += part;
    }
    if (!reached) continue;
    moved.row = row;
    moved.mass = mass;
    moved_[moved_count_++] = moved;
  }
  if (moved_count_ <= old_most) return;
  // Keep the likeliest; of equals the first.
  std::array<double, 3 * most> masses;
  for (std::size_t i = 0; i < moved_count_; ++i) masses[i] = moved_[i].mass;
  const auto last = masses.begin() + old_most - 1;
  std::nth_element(masses.begin(), last, masses.begin() + static_cast<std::ptrdiff_t>(moved_count_),
                   std::greater<>());
  const double least = *last;
  std::size_t equals =
      static_cast<std::size_t>(std::count(masses.begin(), masses.begin() + old_most, least));
  std::size_t kept = 0;
  for (std::size_t i = 0; i < moved_count_; ++i) {
    if (moved_[i].mass < least || (moved_[i].mass == least && equals == 0)) continue;
    if (moved_[i].mass == least) --equals;
    moved_[kept++] = moved_[i];
  }
  moved_count_ = kept;
}

void PlaceBelief::give_birth(const View& view, double mass) noexcept {
  // The rows beyond those that may be searched are gone.
  while (moved_count_ > 0 && moved_[moved_count_ - 1].row >= view.rows) --moved_count_;
  if (mass <= 0.0) return;
  for (const CandidateProposals::Alike& found : view.seen->found()) {
    const auto known = moved_.first(moved_count_);
    const auto place = std::ranges::lower_bound(known, found.row, {}, &Hypothesis::row);
    if (place != known.end() && place->row == found.row) {
      const double share = place->mass / (place->mass + mass);
      place->mass += mass;
      place->gain *= share;
      place->contrast *= share;
      place->age *= share;
      continue;
    }
    std::move_backward(place, known.end(), known.end() + 1);
    *place = {found.row, mass, 0.0, -10.0, 0.0, 0.0, no_parent};
    ++moved_count_;
  }
}

double PlaceBelief::share(const View& view, std::uint64_t frame, std::size_t row) noexcept {
  ++sketches_;
  return view.map->rows().look_closely(view.queries->rows(), view.queries->row_of(frame),
                                       view.map->order().slot(row)) /
         close_bits;
}

void PlaceBelief::weigh(const View& view, const Scene& scene) noexcept {
  std::array<double, most> gains{};
  const double w = scene.novelty;
  count_ = moved_count_;
  for (std::size_t i = 0; i < count_; ++i) {
    Hypothesis& at = rows_[i] = moved_[i];
    const double here = share(view, view.newest, at.row);
    double contrast = 0.0;
    if (view.newest >= view.oldest + apart) {
      const CandidateRun session = view.map->order().around(at.row);
      double around = 2.0 * share(view, view.newest - apart, at.row);
      double weight = 2.0;
      if (at.row >= session.first + apart) {
        around += share(view, view.newest, at.row - apart);
        weight += 1.0;
      }
      if (at.row + apart < std::min(view.rows, session.last)) {
        around += share(view, view.newest, at.row + apart);
        weight += 1.0;
      }
      contrast = (around / weight - here) / scene.deviation;
    }
    const double z = (scene.mean - here) / scene.deviation;
    const double l = std::clamp(z + 0.7 * contrast - scene.bias, -1.5, 3.0);
    gains[i] = l;
    at.mass *= exponential(w * l);
    at.gain = decay * at.gain + w * l;
    at.contrast = decay * at.contrast + (1.0 - decay) * contrast;
    at.age += w;
  }
  sharpen(view.map->order(), scene, std::span(gains).first(count_));
  double sum = new_place_;
  for (const Hypothesis& at : rows_.first(count_)) sum += at.mass;
  for (Hypothesis& at : rows_.first(count_)) at.mass /= sum;
  new_place_ /= sum;
  for (double& gain : gains) gain *= w;
  write_trace(std::span(gains).first(count_));
}

/// Where the scene hardly changes, rows side by side cannot be told apart by single frames; their
/// sum stays.
void PlaceBelief::sharpen(const PlaceOrder& order, const Scene& scene,
                          std::span<const double> gains) noexcept {
  constexpr std::size_t near = 5;
  std::array<double, most> sharp{};
  const double weight = 0.2 * (1.0 - scene.novelty);
  for (std::size_t i = 0; i < count_; ++i) {
    sharp[i] = rows_[i].mass * exponential(weight * gains[i]);
  }
  std::array<double, most> result{};
  std::size_t first = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    double before = 0.0;
    double after = 0.0;
    while (order.apart(rows_[first].row, rows_[i].row) > near) ++first;
    for (std::size_t j = first; j < count_ && order.apart(rows_[j].row, rows_[i].row) <= near;
         ++j) {
      before += rows_[j].mass;
      after += sharp[j];
    }
    result[i] = after > 0.0 ? sharp[i] * before / after : rows_[i].mass;
  }
  for (std::size_t i = 0; i < count_; ++i) rows_[i].mass = result[i];
}

void PlaceBelief::judge(const View& view, const Scene& scene) noexcept {
  const std::span<const Hypothesis> rows = rows_.first(count_);
  const auto top = std::ranges::max_element(rows, {}, &Hypothesis::mass);
  if (top == rows.end()) return;
  double place = 0.0;
  double wrong = -2.0;
  for (const Hypothesis& other : rows) {
    if (view.map->same_place(other.row, top->row)) {
      place += other.mass;
    } else {
      wrong = std::max(wrong, other.gain);
    }
  }
  // Somewhere new the best row is a wrong one too.
  constexpr double half = 0.5;
  if (new_place_ > half) wrong = std::max(wrong, top->gain);
  if (scene.novelty > least_novelty) {
    constexpr double longest = 300.0;
    if (wrong_weight_ == 0.0) wrong_.mean = wrong;
    const double share = 1.0 / std::min(wrong_weight_ + 1.0, longest);
    wrong_weight_ += 2.0 * scene.novelty;
    wrong_.follow(wrong, share);
  }
  constexpr double tiny = 1e-12;
  const double sure = std::clamp(place, tiny, 1.0 - tiny);
  likeliest_ = Likeliest{top->row,
                         static_cast<std::size_t>(top - rows.begin()),
                         {logarithm(sure) - logarithm(1.0 - sure), 0.0, wrong_.lead(top->gain),
                          top->contrast, logarithm(1.0 + top->age)}};
}

double PlaceBelief::usual_gain() const noexcept {
  return (1.0 - decay) * std::max(0.0, wrong_.mean);
}

double PlaceBelief::remember(double odds) noexcept {
  constexpr double fading = 0.03;
  double& past = rows_[likeliest_->index].past;
  past = std::max(past - fading, odds);
  return past;
}

void PlaceBelief::write_trace(std::span<const double> gains) noexcept {
  const std::span<Traced> now =
      traces_.subspan(static_cast<std::size_t>(seen_ % depth_) * most, most);
  for (std::size_t i = 0; i < count_; ++i) {
    now[i] = {static_cast<std::uint32_t>(rows_[i].row), rows_[i].parent,
              static_cast<float>(gains[i])};
  }
  ++seen_;
}

std::size_t PlaceBelief::trace(std::size_t index, std::span<Step> out) const noexcept {
  const auto held = static_cast<std::size_t>(std::min<std::uint64_t>({seen_, depth_, out.size()}));
  std::size_t back = 0;
  while (back < held && index != no_parent) {
    const Traced& at =
        traces_[static_cast<std::size_t>((seen_ - 1 - back) % depth_) * most + index];
    out[back++] = {at.row, static_cast<double>(at.gain)};
    index = at.parent;
  }
  return back;
}

void PlaceBelief::pass(const PlaceOrder& order, std::uint64_t frames, std::size_t rows) noexcept {
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const std::size_t before = std::exchange(count_, 0);
    for (std::size_t i = 0; i < before; ++i) {
      const std::size_t row = rows_[i].row;
      if (order.apart(row, row + rows) != rows) continue;
      Hypothesis& at = rows_[count_++] = rows_[i];
      at.row = row + rows;
      at.parent = static_cast<std::uint32_t>(i);
    }
    const std::array<double, most> gains{};
    write_trace(std::span(gains).first(count_));
  }
}

void PlaceBelief::removed(std::size_t row) noexcept {
  for (Hypothesis& at : rows_.first(count_)) {
    if (at.row > row) --at.row;
  }
  for (Traced& at : traces_) {
    if (at.row > row) --at.row;
  }
}

void PlaceBelief::restart() noexcept {
  count_ = 0;
  seen_ = 0;
  new_place_ = 1.0;
  likeliest_.reset();
}

}  // namespace seqloop
