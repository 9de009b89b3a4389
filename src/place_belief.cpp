// SPDX-License-Identifier: MIT
#include "seqloop/detail/place_belief.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "seqloop/detail/kept_row.hpp"
#include "seqloop/detail/portable_math.hpp"

namespace seqloop {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

// Chances of a novel frame: to leave the map; to come back onto it.
constexpr double leaving = 0.01;
constexpr double coming = 0.001;

// A small map is a small part of the world: it is the less likely to be come back to.
constexpr double small_map = 200.0;

// A robot that is switched on, and has a map of earlier drives, is likelier on it than one that has
// just left it; so is one that is carried from place to place.
constexpr double coming_at_first = 0.1;

// A robot that nears the stretch which another one has just begun sees its first rows from afar,
// and among few rows, all of that stretch, they stand out as if it were there.
constexpr std::size_t least_taken_in = 100;

// How unique a window's best line has to be, and the part of what comes onto the map that then
// comes where the line leads: a place that no single frame shows well is born with too little
// otherwise.
constexpr double stands_out = 0.97;
constexpr double where_it_leads = 0.25;

// How much of a hypothesis' pace is its last move. A robot that adds places leaves those it knows:
// a hypothesis that slowed down quickly would linger beside the road, and one that slows down
// though the newest frames raise so much doubt does. What hardly differs from one is no other pace;
// an earlier drive's places are passed more slowly than the robot's own as often as not.
constexpr double last_move = 0.1;
constexpr double last_move_of_a_slow_one = 0.05;
constexpr double most_doubt_of_a_slower_one = 2.0;
constexpr double slow_pace = 0.65;
constexpr double slow_pace_of_earlier = 0.85;
constexpr double fast_pace = 1.35;

// The chance of a jump from which on rows that go on at another pace than the robot are likelier to
// be of another place.
constexpr double jumps_often = 0.01;

constexpr double most_forgotten = 0.05;  // of a sum or mean over frames, with each

// By novelty: a row that gains less may not be right any more, unless it never gained as much.
constexpr double right_gain = 1.25;
constexpr double part_of_usual = 0.75;
constexpr double newest_gain = 0.02;  // in what it usually gains, by novelty
constexpr double doubt_lost = 0.015;  // by novelty: a bad stretch is forgotten by the way

constexpr std::size_t found_most = 15;
constexpr std::size_t old_most = PlaceBelief::most - found_most - 1;  // one comes by the line

/// What a sum of gains loses with a frame: less where that tells little, so that a fast camera's is
/// of as much of the way as a slow one's. @param novelty 0 .. 1
double forgotten_by(double novelty) {
  constexpr double share = 0.22;
  return std::min(most_forgotten, share * novelty);
}

/// The n-th highest value, and how many are higher. Unlike `std::nth_element` it asks of no value
/// where to go on: processors guess such answers wrong.
/// @param values in any order afterwards. @param n 1 .. as many as there are
std::pair<double, std::size_t> highest(std::span<double> values, std::size_t n) noexcept {
  std::size_t first = 0;
  std::size_t last = values.size();
  while (true) {
    const double middle = values[first + (last - first) / 2];
    // Higher ones to the front, then those that are equal.
    const auto gather = [&](std::size_t from, auto goes_first) {
      for (std::size_t i = from; i < last; ++i) {
        const double value = values[i];
        values[i] = values[from];
        values[from] = value;
        from += static_cast<std::size_t>(goes_first(value));
      }
      return from;
    };
    const std::size_t higher = gather(first, [&](double value) { return value > middle; });
    if (higher >= n) {
      last = higher;
      continue;
    }
    const std::size_t equal = gather(higher, [&](double value) { return !(value < middle); });
    if (equal >= n) return {middle, higher};
    first = equal;
  }
}

/// Chances of a robot that goes on by so many rows a frame, 0 .. 2: between those of one that
/// stays, goes by one, and by two.
Moves moves_at(double pace) {
  constexpr std::array<Moves, 3> of{{{0.92, 0.06, 0.02}, {0.06, 0.88, 0.06}, {0.02, 0.06, 0.92}}};
  const std::size_t slower = pace < 1.0 ? 0 : 1;
  const double faster = pace - static_cast<double>(slower);
  Moves moves;
  for (std::size_t by = 0; by < moves.size(); ++by) {
    moves[by] = (1.0 - faster) * of[slower][by] + faster * of[slower + 1][by];
  }
  return moves;
}

bool used(const MatcherConfig& config) { return config.decision == Decision::probability; }

}  // namespace

PlaceBelief::PlaceBelief(Arena& arena, const MatcherConfig& config)
    : localises_(config.use == Use::localise),
      rows_(arena.take<Hypothesis>("hypotheses", used(config) ? most : 0)),
      next_(arena.take<Hypothesis>("hypotheses of the next frame", used(config) ? most : 0)),
      moved_(arena.take<Moved>("hypotheses that have moved", used(config) ? 3 * most : 0)),
      gauge_(arena, used(config)),
      first_frames_(arena, used(config)),
      traces_(arena, depth(config), most) {}

std::size_t PlaceBelief::observe(const SceneView& view, double jumps) noexcept {
  sketches_ = 0;
  likeliest_.reset();
  prefetch(view);
  const std::optional<Scene> scene = gauge_.look(view, sketches_);
  if (!scene) {
    restart();
    return sketches_;
  }
  const bool earlier_drives = has_earlier_drives(localises_, view.map->order());
  if (earlier_drives) first_frames_.take(view, *scene);
  const bool begins = weighed_++ < FirstFrames::most;
  if (count_ == 0 && view.rows < least_rows_) {
    wrong_.take({});
    return sketches_;
  }
  const double rarely = begins && earlier_drives ? coming_at_first : coming;
  const double comes = std::max(rarely, std::min(coming_at_first, jumps)) *
                       std::min(1.0, static_cast<double>(view.rows) / small_map);
  const double born = comes * std::min(1.0, 4.0 * scene->novelty) * new_place_;
  const std::optional<std::size_t> led_to = std::exchange(expected_, std::nullopt);
  const double by_line = led_to && *led_to < view.rows ? where_it_leads * born : 0.0;
  const double each = (born - by_line) / static_cast<double>(view.seen->scanned().size());
  std::array<Moves, most> moves;
  std::ranges::transform(rows_.first(count_), moves.begin(), [&](const Hypothesis& at) {
    return moves_of(view.map->order(), at, *scene, jumps);
  });
  // In a drive's own map what is believed less than a row that is found anew will be found again.
  move(view.map->order(), moves, earlier_drives ? 0.0 : each);
  new_place_ -= born;
  leave(leaving * scene->novelty);
  give_birth(view, each);
  if (by_line > 0.0) bear(*led_to, by_line);
  hand_over(*view.map);
  weigh(view, *scene);
  judge(view, *scene, jumps);
  return sketches_;
}

/// Has the processor fetch what weighing the rows found will read and their finding has not.
void PlaceBelief::prefetch(const SceneView& view) noexcept {
  const PlaceOrder& order = view.map->order();
  for (const CandidateProposals::Alike& found : view.seen->found()) {
    if (found.row + frames_apart >= view.rows) continue;
    view.map->rows().prefetch_sketches(order.slot(found.row + frames_apart), 1);
  }
}

/// A robot may pass places at another pace than it, or an earlier drive, did: there a hypothesis
/// goes on at its own.
Moves PlaceBelief::moves_of(const PlaceOrder& order, const Hypothesis& at, const Scene& scene,
                            double jumps) const noexcept {
  const double slow = is_of_this_drive(order, at.row) ? slow_pace : slow_pace_of_earlier;
  const bool at_its_pace = scene.drives() && jumps <= jumps_often &&
                           (localises_ || at.pace < slow || at.pace > fast_pace);
  return at_its_pace ? moves_at(at.pace) : scene.moves();
}

/// Moves the belief on by a frame: each row now comes from its likeliest predecessor.
/// @param moves of each hypothesis
/// @param least belief in a row that is not forgotten
void PlaceBelief::move(const PlaceOrder& order, std::span<const Moves> moves,
                       double least) noexcept {
  moved_count_ = 0;
  ended_ = {};
  std::array<std::size_t, 3> next{};
  while (true) {
    std::size_t row = static_cast<std::size_t>(-1);
    for (std::size_t by = 0; by < next.size(); ++by) {
      if (next[by] < count_) row = std::min(row, rows_[next[by]].row + by);
    }
    if (row == static_cast<std::size_t>(-1)) break;
    std::size_t likeliest = most;
    double best = 0.0;
    double mass = 0.0;
    bool reached = false;
    for (std::size_t by = 0; by < next.size(); ++by) {
      // Two are of one row where a row between them has gone from the map.
      for (; next[by] < count_ && rows_[next[by]].row + by == row; ++next[by]) {
        const std::size_t from = next[by];
        const double part = moves[from][by] * rows_[from].mass;
        if (row >= order.size() || order.apart(rows_[from].row, row) != by) {
          ended_.mass += part;
          if (part > ended_.most && rows_[from].row < order.size())
            ended_ = {ended_.mass, part, from};
          continue;
        }
        reached = true;
        if (part > best) {
          best = part;
          likeliest = from;
        }
        mass += part;
      }
    }
    if (!reached || mass < least) continue;
    moved_[moved_count_++] = {
        row, mass, 1.0,
        likeliest < most ? static_cast<BeliefTraces::Index>(likeliest) : BeliefTraces::none};
  }
  if (moved_count_ > old_most) keep_likeliest();
}

/// Of what has moved; of equals the first.
void PlaceBelief::keep_likeliest() noexcept {
  std::array<double, 3 * most> masses;
  std::ranges::transform(moved_.first(moved_count_), masses.begin(), &Moved::mass);
  const auto [least, more] = highest(std::span(masses).first(moved_count_), old_most);
  std::size_t equals = old_most - more;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < moved_count_; ++i) {
    if (moved_[i].mass < least || (moved_[i].mass == least && equals == 0)) continue;
    if (moved_[i].mass == least) --equals;
    moved_[kept++] = moved_[i];
  }
  moved_count_ = kept;
}

/// A share of the belief in rows goes to "somewhere new".
void PlaceBelief::leave(double share) noexcept {
  double on = ended_.mass;
  for (Moved& moved : moved_.first(moved_count_)) {
    on += moved.mass;
    moved.mass *= 1.0 - share;
  }
  ended_.mass *= 1.0 - share;
  new_place_ += share * on;
}

void PlaceBelief::give_birth(const SceneView& view, double mass) noexcept {
  // The rows beyond those that may be searched are gone.
  while (moved_count_ > 0 && moved_[moved_count_ - 1].row >= view.rows) --moved_count_;
  if (mass <= 0.0) return;
  const auto found = view.seen->found();
  for (const CandidateProposals::Alike& at : found.first(std::min(found.size(), found_most))) {
    bear(at.row, mass);
  }
}

/// Gives belief that has come onto the map to a row.
void PlaceBelief::bear(std::size_t row, double mass) noexcept {
  const auto known = moved_.first(moved_count_);
  const auto place = std::ranges::lower_bound(known, row, {}, &Moved::row);
  if (place != known.end() && place->row == row) {
    place->share *= place->mass / (place->mass + mass);
    place->mass += mass;
    return;
  }
  std::move_backward(place, known.end(), known.end() + 1);
  *place = {row, mass, 1.0, BeliefTraces::none};
  ++moved_count_;
}

/// Where the rows of a session end, belief goes on with other visits of the place, and with it how
/// the robot came there: one half in equal shares, for nobody knows which of the rows it is, the
/// other half by what is believed of them already.
void PlaceBelief::hand_over(const PlaceMap& map) noexcept {
  if (ended_.most <= 0.0) return;
  const std::size_t end = rows_[ended_.from].row;
  const auto goes_on = [&](const Moved& moved) {
    return map.same_place(moved.row, end) && map.order().apart(moved.row, end) > PlaceMap::beside;
  };
  const std::span<Moved> all = moved_.first(moved_count_);
  double count = 0.0;
  double sum = 0.0;
  for (const Moved& moved : all) {
    if (!goes_on(moved)) continue;
    count += 1.0;
    sum += moved.mass;
  }
  if (sum <= 0.0) return;
  constexpr double half = 0.5;
  for (Moved& moved : all) {
    if (!goes_on(moved)) continue;
    const double part = half * ended_.mass * (1.0 / count + moved.mass / sum);
    if (part > moved.mass) {
      moved.share = 1.0;
      moved.parent = static_cast<BeliefTraces::Index>(ended_.from);
    }
    moved.mass += part;
  }
}

/// The pace of a hypothesis that went on by so many rows.
double PlaceBelief::pace_after(const Hypothesis& at, double by) const noexcept {
  const double pace = at.pace + last_move * (by - at.pace);
  if (localises_ || pace >= 1.0) return pace;
  if (by < at.pace && at.doubt > most_doubt_of_a_slower_one) return at.pace;
  return at.pace + last_move_of_a_slow_one * (by - at.pace);
}

/// Makes a hypothesis of what has moved.
void PlaceBelief::take_on(const PlaceOrder& order, Hypothesis& at, const Moved& moved,
                          bool drives) const noexcept {
  if (moved.parent == BeliefTraces::none) {
    at = {};
  } else {
    at = rows_[moved.parent];
    // Far where it is handed over from another visit of the place.
    const std::size_t by = order.apart(at.row, moved.row);
    if (drives && by <= 2) at.pace = pace_after(at, static_cast<double>(by));
  }
  at.row = moved.row;
  at.mass = moved.mass;
  at.parent = moved.parent;
  at.gain *= moved.share;
  at.wrong *= moved.share;
  at.contrast *= moved.share;
  at.age *= moved.share;
}

/// The row that a hypothesis was at as the frame before came, that it is compared with; none where
/// it was not, has hardly moved since, or came by another visit of its place.
std::optional<std::size_t> PlaceBelief::came_from(const PlaceOrder& order,
                                                  const Hypothesis& at) const noexcept {
  constexpr std::size_t least = 2;
  constexpr std::size_t most_rows = 2 * frames_apart;
  // The newest frame's parents are of the frame before it.
  const auto from = traces_.row_before(at.parent, frames_apart - 1);
  if (!from || *from < order.around(at.row).first) return std::nullopt;
  if (*from + least > at.row || *from + most_rows < at.row) return std::nullopt;
  return from;
}

void PlaceBelief::weigh(const SceneView& view, const Scene& scene) noexcept {
  const PlaceOrder& order = view.map->order();
  const QueryHistory& queries = *view.queries;
  const std::size_t newest = queries.row_of(view.newest);
  FramePair frames{queries.moved().close_sketch(newest), std::nullopt};
  if (view.newest >= view.oldest + frames_apart) {
    const std::size_t before = queries.row_of(view.newest - frames_apart);
    frames.before = queries.moved().close_sketch(before);
    frames.way = squared_way(queries.rows(), newest, before, sketches_);
  }
  std::array<double, most> gains;
  std::array<double, most> without_bounds;
  const double w = scene.novelty;
  newest_novelty_ = w;
  count_ = moved_count_;
  for (std::size_t i = 0; i < count_; ++i) {
    Hypothesis& at = next_[i];
    take_on(order, at, moved_[i], scene.drives());
    const RowGain gain = gain_of(scene, *view.map, view.rows, frames, at.row, sketches_);
    const double l = gain.gain;
    gains[i] = l;
    without_bounds[i] = gain.without_bounds;
    at.told = w * l;
    at.step = unknown;
    // Where all rows that were scanned show what the frame does, no change tells them apart.
    if (const auto from = came_from(order, at); from && frames.before && scene.mean > 0.0) {
      at.step = in_step(scene, *view.map, frames, gain, *from, sketches_);
      at.in_step += most_forgotten * (at.step - at.in_step);
    }
    at.mass *= exponential(at.told);
    at.gain = (1.0 - forgotten_by(w)) * at.gain + at.told;
    at.contrast = (1.0 - most_forgotten) * at.contrast + most_forgotten * gain.contrast;
    const double alike = scene.alike(gain.here);
    at.alike =
        at.parent == BeliefTraces::none ? alike : at.alike + most_forgotten * (alike - at.alike);
    at.age += w;
    const double least = std::clamp(part_of_usual * at.usual, 0.0, right_gain);
    at.doubt = std::max(0.0, (1.0 - doubt_lost * w) * at.doubt + scene.change * (least - l));
    at.usual += newest_gain * w * (l - at.usual);
  }
  std::swap(rows_, next_);
  sharpen(order, scene, std::span(gains).first(count_));
  normalise();
  const Shown shown = shown_best(*view.map, std::span(without_bounds).first(count_));
  traces_.next(w, scene.change);
  for (std::size_t i = 0; i < count_; ++i) {
    Hypothesis& at = rows_[i];
    at.shown = without_bounds[i] >= shown.least && view.map->same_place(at.row, shown.row);
    traces_.set(i, at.row, at.parent, at.told, at.step, at.shown);
  }
}

/// A frame by itself shows a row if it is much likelier there than somewhere new, and no less
/// likely than at any other place. @param gains of the hypotheses, without bounds
PlaceBelief::Shown PlaceBelief::shown_best(const PlaceMap& map,
                                           std::span<const double> gains) const noexcept {
  constexpr double much = 3.0;
  Shown best{0, much};
  const auto top = std::ranges::max_element(gains);
  if (top == gains.end()) return best;
  best.row = rows_[static_cast<std::size_t>(top - gains.begin())].row;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    if (!map.same_place(rows_[i].row, best.row)) best.least = std::max(best.least, gains[i]);
  }
  return best;
}

/// Where the scene hardly changes, rows side by side cannot be told apart by single frames; their
/// sum stays.
void PlaceBelief::sharpen(const PlaceOrder& order, const Scene& scene,
                          std::span<const double> gains) noexcept {
  constexpr std::size_t near = 5;
  std::array<double, most> sharp;
  const double weight = 0.2 * (1.0 - scene.novelty);
  for (std::size_t i = 0; i < count_; ++i) {
    sharp[i] = rows_[i].mass * exponential(weight * gains[i]);
  }
  std::array<double, most> result;
  std::size_t first = 0;
  std::size_t last = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    while (order.apart(rows_[first].row, rows_[i].row) > near) ++first;
    while (last < count_ && order.apart(rows_[last].row, rows_[i].row) <= near) ++last;
    double before = 0.0;
    double after = 0.0;
    for (std::size_t j = first; j < last; ++j) {
      before += rows_[j].mass;
      after += sharp[j];
    }
    result[i] = after > 0.0 ? sharp[i] * before / after : rows_[i].mass;
  }
  for (std::size_t i = 0; i < count_; ++i) rows_[i].mass = result[i];
}

/// All rows and "somewhere new" make 1.
void PlaceBelief::normalise() noexcept {
  double sum = new_place_;
  for (const Hypothesis& at : rows_.first(count_)) sum += at.mass;
  for (Hypothesis& at : rows_.first(count_)) at.mass /= sum;
  new_place_ /= sum;
}

bool PlaceBelief::is_likeliest_of_session(const PlaceMap& map, std::size_t row) const noexcept {
  const std::span<const Hypothesis> session = of_session(map.order(), row);
  const auto likeliest = std::ranges::max_element(session, {}, &Hypothesis::mass);
  return likeliest != session.end() && map.same_place(row, likeliest->row);
}

/// Those of the session that a row is of. Work: log of them and of sessions.
std::span<PlaceBelief::Hypothesis> PlaceBelief::of_session(const PlaceOrder& order,
                                                           std::size_t row) const noexcept {
  const CandidateRun session = order.around(row);
  const std::span<Hypothesis> rows = rows_.first(count_);
  const auto first = std::ranges::lower_bound(rows, session.first, {}, &Hypothesis::row);
  const auto last = std::ranges::lower_bound(rows, session.last, {}, &Hypothesis::row);
  return {first, last};
}

void PlaceBelief::judge(const SceneView& view, const Scene& scene, double jumps) noexcept {
  const std::span<Hypothesis> rows = rows_.first(count_);
  const auto top = std::ranges::max_element(rows, {}, &Hypothesis::mass);
  if (top == rows.end()) {
    wrong_.take({});
    return;
  }
  const bool on_map = is_on_map();
  double place = 0.0;
  std::optional<WrongRows::Row> other;
  for (auto left = rows; !left.empty();) {
    // Another session may know the place, too: its likeliest row is no wrong one.
    const std::span<Hypothesis> session = of_session(view.map->order(), left.front().row);
    const auto best = std::ranges::max_element(session, {}, &Hypothesis::mass);
    left = left.subspan(session.size());
    for (Hypothesis& at : session) {
      const bool same = view.map->same_place(at.row, top->row);
      // What a row gained while it was right says nothing about wrong ones.
      at.wrong = (1.0 - forgotten_by(scene.novelty)) * at.wrong + (same && on_map ? 0.0 : at.told);
      if (same) {
        place += at.mass;
        if (on_map) share_history(view.map->order(), *top, at);
      } else if (!view.map->same_place(at.row, best->row) && (!other || at.wrong > other->sum)) {
        other = {at.row, at.wrong};
      }
    }
  }
  const auto index = static_cast<std::size_t>(top - rows.begin());
  if (on_map) know_better(*view.map, index);
  wrong_.take(
      {WrongRows::Row{top->row, top->wrong}, other, on_map, scene.drives() ? scene.novelty : 0.0});
  constexpr double tiny = 1e-12;
  const double sure = std::clamp(place, tiny, 1.0 - tiny);
  // Less than that says no more.
  constexpr double least_new = 1e-4;
  likeliest_ = Likeliest{top->row,
                         index,
                         {.odds = logarithm(sure) - logarithm(1.0 - sure),
                          .known = -logarithm(least_new + new_place_),
                          .lead = wrong_.lead(top->gain),
                          .contrast = top->contrast,
                          .in_step = top->in_step,
                          .age = logarithm(1.0 + top->age),
                          .doubt = top->doubt,
                          .unlike = unlike(*view.map, *top),
                          .jumps = jumps}};
}

/// Another visit of the likeliest row's place takes over how the robot came here. Where the visit
/// that is followed ends, or its rows go from the map, the other one need not start anew.
void PlaceBelief::share_history(const PlaceOrder& order, const Hypothesis& top,
                                Hypothesis& at) noexcept {
  if (at.past >= top.past || order.apart(at.row, top.row) <= PlaceMap::beside) return;
  at.past = top.past;
  at.age = std::max(at.age, top.age);
  const auto index = static_cast<std::size_t>(&at - rows_.data());
  at.parent = top.parent;
  traces_.set_parent(index, at.parent);
}

bool PlaceBelief::is_of_this_drive(const PlaceOrder& order, std::size_t row) const noexcept {
  return !localises_ && row >= order.newest_session().first;
}

/// How much less alike a place looks than it has to. Who is back within 100 rows is back in the
/// same light. What comes again so soon, and looks little like it was, is a wiper on the lens, say,
/// or one rack after the other.
double PlaceBelief::unlike(const PlaceMap& map, const Hypothesis& at) const noexcept {
  constexpr std::size_t soon = 100;
  constexpr double least = 0.45;
  if (!is_of_this_drive(map.order(), at.row) || map.size() - at.row >= soon) return 0.0;
  return std::max(0.0, least - at.alike);
}

/// Which rows were wrong some frames ago, by the trace of what is the likeliest row now and on the
/// map.
void PlaceBelief::know_better(const PlaceMap& map, std::size_t index) noexcept {
  WrongRows::Frame* const then = wrong_.due();
  if (then == nullptr || !then->likeliest) return;
  std::array<BeliefTraces::Step, WrongRows::lag + 1> steps;
  if (traces_.trace(index, steps) < steps.size()) return;
  const std::size_t right = steps.back().row;
  if (map.same_place(then->likeliest->row, right)) {
    then->on_map = true;
  } else if (then->other && map.same_place(then->other->row, right)) {
    then->other = then->likeliest;
    then->on_map = true;
  }
}

double PlaceBelief::usual_gain() const noexcept {
  // A little more than they do: 1 would be their mean.
  constexpr double more = 1.3;
  const double novelty = wrong_.novelty();
  return more * forgotten_by(novelty) * std::max(0.0, wrong_.mean()) / novelty;
}

double PlaceBelief::remember(double odds) noexcept {
  constexpr double too_much = 3.0;
  const bool has_left = localises_ ? !is_on_map() : likeliest_->evidence.doubt > too_much;
  // Other visits of the place have had it from this row.
  if (has_left) {
    for (Hypothesis& at : rows_.first(count_)) at.past = std::min(at.past, odds);
  }
  double& past = rows_[likeliest_->index].past;
  past = std::max(past, odds);
  return past;
}

void PlaceBelief::expect(std::size_t row, double uniqueness) noexcept {
  if (uniqueness <= stands_out) expected_ = row;
}

void PlaceBelief::pass(const PlaceOrder& order, std::uint64_t frames, std::size_t rows) noexcept {
  expected_.reset();
  first_frames_.repeat(frames);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    traces_.next(0.0, 0.0);
    wrong_.take({});
    const std::size_t before = std::exchange(count_, 0);
    for (std::size_t i = 0; i < before; ++i) {
      const std::size_t row = rows_[i].row;
      if (order.apart(row, row + rows) != rows) continue;
      rows_[count_] = rows_[i];
      rows_[count_].row = row + rows;
      traces_.set(count_++, row + rows, static_cast<BeliefTraces::Index>(i), 0.0, unknown, false);
    }
  }
}

/// Moves on to the last row of the session at most: beyond it something would have to be seen.
Moves PlaceBelief::unseen_moves_of(const PlaceOrder& order, const Hypothesis& at) noexcept {
  const std::size_t left = order.around(at.row).last - 1 - at.row;
  Moves moves = of_unseen_motion;
  for (std::size_t by = moves.size() - 1; by > left; --by) {
    moves[left] += std::exchange(moves[by], 0.0);
  }
  return moves;
}

void PlaceBelief::drift(const PlaceMap& map, bool is_step) noexcept {
  std::array<Moves, most> moves;
  std::ranges::transform(rows_.first(count_), moves.begin(),
                         [&](const Hypothesis& at) { return unseen_moves_of(map.order(), at); });
  // What is left has come from somewhere.
  constexpr double any = std::numeric_limits<double>::min();
  move(map.order(), moves, any);
  if (is_step) {
    expected_.reset();
    first_frames_.repeat(1);
    wrong_.take({});
    traces_.next(0.0, 0.0);
  }
  count_ = moved_count_;
  for (std::size_t i = 0; i < count_; ++i) {
    Hypothesis& at = next_[i];
    take_on(map.order(), at, moved_[i], false);
    at.past = Hypothesis{}.past;
    if (is_step) {
      at.told = 0.0;
      at.step = unknown;
      at.shown = false;
    } else {
      at.parent = rows_[moved_[i].parent].parent;
    }
    traces_.set(i, at.row, at.parent, at.told, at.step, at.shown);
  }
  std::swap(rows_, next_);
  normalise();
}

void PlaceBelief::removed(std::size_t row, bool forgotten) noexcept {
  for (Hypothesis& at : rows_.first(count_)) {
    count_without(row, false, at.row);
  }
  if (likeliest_) count_without(row, false, likeliest_->row);
  if (expected_) count_without(row, false, *expected_);
  traces_.removed(row, forgotten);
  wrong_.removed(row);
}

void PlaceBelief::inserted(std::size_t row) noexcept {
  for (Hypothesis& at : rows_.first(count_)) {
    count_with(row, at.row);
  }
  if (likeliest_) count_with(row, likeliest_->row);
  if (expected_) count_with(row, *expected_);
  traces_.inserted(row);
  wrong_.inserted(row);
}

void PlaceBelief::taken_in(std::size_t capacity) noexcept {
  if (localises_) least_rows_ = std::min(least_taken_in, capacity);
}

void PlaceBelief::restart() noexcept {
  count_ = 0;
  weighed_ = 0;
  new_place_ = 1.0;
  likeliest_.reset();
  expected_.reset();
  traces_.restart();
  first_frames_.restart();
  wrong_.settle();
}

}  // namespace seqloop
