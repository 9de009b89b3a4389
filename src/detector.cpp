// SPDX-License-Identifier: MIT
#include "seqloop/detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "seqloop/detail/calibration.hpp"
#include "seqloop/detail/detector_faults.hpp"
#include "seqloop/detail/evidence.hpp"
#include "seqloop/detail/lowest_lines.hpp"
#include "seqloop/detail/portable_math.hpp"
#include "seqloop/detail/sketch.hpp"
#include "seqloop/detail/stop_run.hpp"
#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

const MatcherConfig& checked(const MatcherConfig& config, const PlaceMap& map) {
  Faults faults = detector_faults(config, map);
  if (!faults.empty()) throw SetupError(std::move(faults));
  return config;
}

Capacity capacity_of(const PlaceMap& map) { return {map.capacity(), map.descriptor_size()}; }

/// The rows of the map that are of the running drive.
CandidateRun running(const MatcherConfig& config, const PlaceOrder& order) {
  if (config.use == Use::localise) return {order.size(), order.size()};
  return order.newest_session();
}

/// Query descriptors that must be kept: the window's, and what the change degree of its centre
/// looks back on. A whole number of what is taken at once, so that this lies in one piece unless
/// some came by themselves.
std::size_t queries_kept(const MatcherConfig& config) {
  const std::size_t ds = config.sequence_length;
  const std::size_t kept =
      std::max({ds + 1, ds - ds / 2 + ChangeDegree::reach + 1, PlaceBelief::reach + 1});
  const std::size_t at_once = config.frames_at_once;
  return (kept + at_once - 1 + at_once - 1) / at_once * at_once;
}

/// How unlike places of a map usually are that are so many rows apart: 1 is as unlike as two that
/// have nothing to do with each other. None where there are too few of them to tell.
std::optional<double> usually_unlike(const PlaceMap& map, std::size_t apart) {
  constexpr std::size_t least = 20;
  constexpr std::size_t most = 255;
  const PlaceOrder& order = map.order();
  if (order.size() < least) return std::nullopt;
  std::array<double, most> found;
  const std::size_t pairs = std::min(most, order.size() - apart);
  std::size_t count = 0;
  for (std::size_t i = 0; i < pairs; ++i) {
    const std::size_t row = i * (order.size() - apart) / pairs;
    if (order.apart(row, row + apart) != apart) continue;
    const double d = chord(
        map.rows().look_closely(map.rows().close_sketch(order.slot(row)), order.slot(row + apart)) /
        DescriptorRows::close_bits);
    found[count++] = d * d / 2.0;
  }
  if (count < least / 2) return std::nullopt;
  const auto middle = found.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(found.begin(), middle, found.begin() + static_cast<std::ptrdiff_t>(count));
  return *middle;
}

/// How unlike neighbours among the places of a map usually are. Snow, rain and noise are others in
/// each frame, so that places are unlike by as much however near they are: that is left out where
/// it is a good part. What is alike beside it falls by the same share from row to row.
std::optional<double> spacing_of(const PlaceMap& map) {
  constexpr double mostly = 0.7;
  constexpr double something = 0.2;  // alike, or nobody can tell
  const std::optional<double> one = usually_unlike(map, 1);
  const std::optional<double> two = usually_unlike(map, 2);
  if (!one || !two || 1.0 - *one < something) return one;
  const double without = std::max(0.0, (*two - *one) / (1.0 - *one));
  return without < mostly * *one ? without : *one;
}

/// Steps whose frames are asked for: those that wait, the newest that are no candidates yet, and
/// those that come at once where frames were held back.
std::size_t steps_kept(const MatcherConfig& config) {
  const std::size_t newest = config.use == Use::close_loops ? config.exclude : 0;
  return std::max(config.patience, newest) + 3 * config.sequence_length + config.frames_at_once +
         StopRun::reach + 2;
}

/// Frames whose steps are asked for: those that wait, and as many as may be skipped at once.
std::size_t frames_kept(const MatcherConfig& config) {
  return config.patience + config.sequence_length + config.frames_at_once + 2;
}

/// Answers that may become due at once.
std::size_t answers_kept(const MatcherConfig& config) {
  return config.patience + 2 * config.frames_at_once + 1;
}

/// Whether a descriptor is what its difference wants: finite, and for Euclid of unit length
/// (Algorithm 1) or all zero. One that is not would spoil the running statistics for the rest of
/// the drive.
bool well_formed(std::span<const float> values, const MatcherConfig& config) {
  const double squares = squared_norm(values);
  if (blank(config.difference, values))
    return !config.blank_is_unreadable && std::isfinite(squares);
  if (config.difference == Difference::mean_absolute) return std::isfinite(squares);
  constexpr double tolerance = 0.01;
  return std::abs(squares - 1.0) <= tolerance;
}

// As much is told at most of a frame that shows what an unsettled one did.
constexpr auto in_doubt = static_cast<float>(PendingAnswers::most_in_doubt);

/// Frames that the map's statistics weigh for the drive.
std::size_t drive_prior(const MatcherConfig& config) {
  const Standardisation& how = config.standardisation;
  return config.use == Use::localise ? how.prior_where_localised() : how.prior_frames;
}

}  // namespace

Detector::Detector(const MatcherConfig& config, PlaceMap& map, std::span<std::byte> memory)
    : Detector(config, map,
               ArenaMemory(bytes_needed(checked(config, map), capacity_of(map)), memory)) {}

Detector::Detector(const MatcherConfig& config, PlaceMap& map, ArenaMemory&& memory)
    : Detector(Arena(memory.span()), config, &map, capacity_of(map), std::move(memory)) {
  statistics_.start_from(map.statistics(), drive_prior(config));
  shift_.stand_in(map.columns());
  if (config.use == Use::close_loops) static_cast<void>(map.begin_session());
  if (has_keyframes(config)) {
    if (const std::optional<double> spacing = spacing_of(map)) keyframes_.go_by(*spacing);
  }
}

Detector::Detector(Arena arena, const MatcherConfig& config, PlaceMap* map,
                   const Capacity& capacity, ArenaMemory&& memory)
    : memory_(std::move(memory)),
      config_(config),
      map_(map),
      trajectories_(arena, config.sequence_length, config.vmin, config.vmax),
      statistics_(arena, capacity.descriptor_size),
      queries_(arena, DescriptorForm(config, capacity.descriptor_size), queries_kept(config),
               moves_frames(config)),
      shift_(arena, DescriptorForm(config, capacity.descriptor_size), moves_frames(config)),
      slices_(arena, config, queries_, capacity),
      search_(arena, trajectories_, config, capacity.places),
      ranges_(arena, config),
      proposals_(arena, config, capacity.places),
      budget_(arena, config),
      decision_(arena, config),
      belief_(arena, config),
      pending_(arena, config, trajectories_),
      keyframes_(arena, has_keyframes(config) ? capacity.descriptor_size : 0),
      steps_(arena, has_keyframes(config) ? steps_kept(config) : 0,
             has_keyframes(config) ? frames_kept(config) : 0),
      told_(arena.take<Answer>("answers to frames",
                               has_keyframes(config) ? answers_kept(config) : 0)),
      standardised_(arena.take<float>("the newest descriptor", capacity.descriptor_size)) {}

FrameReport Detector::step(std::span<const float> descriptor) noexcept {
  pending_.clear();
  told_count_ = 0;
  return take(descriptor);
}

/// A step whose answers stand beside those of the steps before it.
FrameReport Detector::take(std::span<const float> descriptor) noexcept {
  skipped_ = 0;
  const auto [readable, is_step] = take_query(descriptor);
  if (!is_step) return report_again(readable);
  const std::uint64_t newest = queries_.newest();
  const bool became_place = config_.use == Use::localise || become_place();
  FrameReport report = answer(newest, readable);
  report.map_full = !became_place;
  if (told_.empty()) return report;
  its_answer_.reset();
  last_ = report;
  say_now(report, false);
  tell(report, report.answers);
  say_last(report, newest, readable);
  return report;
}

/// Of a frame that is no step: it shows what the newest one does, or nothing; that is told at once.
FrameReport Detector::report_again(bool readable) noexcept {
  if (readable && may_be_hidden()) lose_sight(false);
  const std::size_t before = pending_.answers().size();
  pending_.answer(*map_, steps_, steps_.frames() - 1, window_began_);
  FrameReport report = last_;
  report.work = {};
  report.full_search = false;
  if (!readable) report.now.reset();
  say_now(report, true);
  const std::optional<Answer> told_before = its_answer_;
  const std::size_t first = told_count_;
  tell(report, pending_.answers().subspan(before));
  if (!readable) {
    told_[told_count_++] = {report.newest, Gate::frame_error, 0.0F, std::nullopt};
  } else if (told_before) {
    tell(*told_before, report.newest, keyframes_.is_settled());
  }
  report.answers = told_.subspan(first, told_count_ - first);
  say_last(report, queries_.newest(), readable);
  return report;
}

/// Whether the robot may drive on behind whatever stands before its camera: the newest frames, more
/// than one, look alike, but not like their place, and not like the frames before them. One that
/// has been carried away before stands where it was put down.
bool Detector::may_be_hidden() const noexcept {
  return !keyframes_.is_dense() && keyframes_.is_cut() && pending_.jumps() <= 0.0 &&
         !pending_.shows_its_place(queries_.newest());
}

/// Whether a stop may be elsewhere than what was believed before it. Of a robot that was carried
/// away and stands, no more is seen than one frame, and all would be wrong together: so that frame
/// must show its place by itself, or it is waited for what is seen later. Where the robot has been
/// carried away before, it may be so again from there: what is seen then tells nothing of where it
/// stood.
/// @param step some frames of which, more than one, show the same behind a cut
bool Detector::may_be_elsewhere(std::uint64_t step) const noexcept {
  const bool carried = pending_.jumps() > 0.0;
  const bool too_early = queries_.newest() - step < config_.sequence_length;
  if (too_early) return carried || !pending_.shows_its_place(step);
  return carried && steps_.is_isolated(step);
}

/// Answers a frame as its step was.
void Detector::tell(const Answer& answer, std::uint64_t frame, bool settled) noexcept {
  Answer& told = told_[told_count_++];
  told = answer;
  told.frame = frame;
  if (!settled && steps_.repeats(answer.frame) && may_be_elsewhere(answer.frame)) {
    told.probability = std::min(told.probability, in_doubt);
  }
  if (!told.match) return;
  // What is accepted may have changed, too, since the answer was given for the step's first frames.
  if (pending_.accepts(told.probability)) {
    told.gate = Gate::match;
  } else if (told.gate == Gate::match) {
    told.gate = Gate::unsure;
  }
  const auto stop = steps_.stop_at(answer.frame);
  const StopFrame at = answered_.at(*map_, stop, frame, told.match->place);
  told.match->place = at.place;
  told.match->stood = at.stood;
  if (!stop && told.gate == Gate::match) answered_.was_at(frame, at.place);
}

/// Says which frame of a stop the newest one is believed to be.
/// @param repeats whether it shows what the newest step does
void Detector::say_now(FrameReport& report, bool repeats) noexcept {
  if (!report.now) return;
  if (repeats && !keyframes_.is_settled()) {
    report.now->probability = std::min(report.now->probability, in_doubt);
  }
  const std::uint64_t frame = steps_.frames() - 1;
  const auto stop = steps_.stop_at(queries_.newest());
  const StopFrame at = believed_.at(*map_, stop, frame, report.now->place);
  report.now->place = at.place;
  report.now->stood = at.stood;
  constexpr auto likely = static_cast<float>(PlaceMap::likely);
  if (!stop && report.now->probability >= likely) believed_.was_at(frame, at.place);
}

/// Puts frames into a report for steps. @param answers to steps
void Detector::tell(FrameReport& report, std::span<const Answer> answers) noexcept {
  const std::size_t first = told_count_;
  for (const Answer& answer : answers) {
    steps_.frames_of(answer.frame,
                     [&](std::uint64_t frame, bool settled) { tell(answer, frame, settled); });
    if (answer.frame == queries_.newest()) its_answer_ = answer;
  }
  report.newest = steps_.frames() - 1;
  report.answers = told_.subspan(first, told_count_ - first);
}

std::size_t Detector::steps(std::span<const std::span<const float>> descriptors,
                            std::span<FrameReport> reports) noexcept {
  const bool in_blocks =
      config_.arithmetic == Arithmetic::int8 ||
      (config_.arithmetic == Arithmetic::float32 && config_.difference == Difference::euclidean);
  const bool at_once = config_.candidates == Candidates::all && config_.use == Use::localise &&
                       !config_.enhance && in_blocks;
  const std::size_t count = std::min({descriptors.size(), reports.size(), config_.frames_at_once});
  pending_.clear();
  told_count_ = 0;
  if (!at_once) {
    for (std::size_t i = 0; i < count; ++i) reports[i] = take(descriptors[i]);
    return count;
  }
  const std::uint64_t first = queries_.frames();
  std::array<bool, MatcherConfig::most_frames_at_once> readable;
  skipped_ = 0;
  for (std::size_t i = 0; i < count; ++i) readable[i] = take_query(descriptors[i]).readable;
  slices_.fill_newest(*map_, count);
  for (std::size_t i = 0; i < count; ++i) {
    reports[i] = answer(first + i, readable[i]);
    reports[i].work.distances += map_->size();
  }
  return count;
}

/// Answers the frames whose answer is due once the newest has been taken.
FrameReport Detector::answer(std::uint64_t newest, bool readable) noexcept {
  if (config_.decision == Decision::probability) {
    pending_.add(newest, readable, shift_.halves());
    FrameReport report = match_centre(newest, readable);
    report_due(report, readable);
    return report;
  }
  const std::size_t before = pending_.answers().size();
  FrameReport report = match_centre(newest, readable);
  // Before the window is whole there is none, not even where the newest frame cannot be read.
  if (newest >= window_began_ + config_.sequence_length) {
    pending_.say(
        {*report.frame, report.gate, std::numeric_limits<float>::quiet_NaN(), report.match});
  }
  report.answers = pending_.answers().subspan(before);
  return report;
}

void Detector::report_due(FrameReport& report, bool readable) noexcept {
  const std::size_t before = pending_.answers().size();
  if (readable) {
    report.work.sketches += pending_.believe(belief_, *map_, report.newest, window_began_);
    report.work.distances += learn_shift();
  }
  pending_.answer(*map_, steps_, steps_.frame_of(report.newest), window_began_);
  report.answers = pending_.answers().subspan(before);
  say_last(report, report.newest, readable);
  if (const auto& likeliest = belief_.likeliest(); likeliest && readable) {
    report.now = Belief{map_->order().number(likeliest->row),
                        static_cast<float>(calibrated_now(log_odds_now(*pending_.evidence()))),
                        static_cast<float>(belief_.new_place())};
  }
}

/// The last of a report's answers, where there are any; what is said without one otherwise.
/// @param newest step
void Detector::say_last(FrameReport& report, std::uint64_t newest, bool readable) const noexcept {
  const bool whole = newest >= window_began_ + config_.sequence_length;
  report.gate = !readable ? Gate::frame_error : whole ? Gate::waiting : Gate::warming_up;
  report.frame.reset();
  report.match.reset();
  if (report.answers.empty()) return;
  report.frame = report.answers.back().frame;
  report.gate = report.answers.back().gate;
  report.match = report.answers.back().match;
}

std::span<const Answer> Detector::finish() noexcept {
  pending_.clear();
  told_count_ = 0;
  const std::uint64_t end = queries_.frames();
  if (end > 0 && config_.decision == Decision::probability)
    pending_.answer(*map_, steps_, steps_.frames() - 1, end);
  FrameReport report;
  report.answers = pending_.answers();
  if (!told_.empty() && end > 0) tell(report, pending_.answers());
  restart();
  shift_.begin();
  keyframes_.begin();
  // Frames that do not come before the next one are none of what has ended.
  skipped_ = config_.sequence_length + 1;
  pending_.forget_drive();
  return report.answers;
}

/// Matches the centre frame of a window whose newest frame has been taken.
FrameReport Detector::match_centre(std::uint64_t newest, bool readable) noexcept {
  FrameReport report;
  report.newest = newest;
  report.k = ranges_.k();
  const std::size_t after_centre = config_.sequence_length - trajectories_.centre();
  report.work.distances = fill_columns(newest);
  const std::size_t rows =
      rows_searched(report.newest - std::min<std::uint64_t>(report.newest, after_centre));
  if (scans(config_)) {
    const CandidateProposals::Looks looks =
        proposals_.look(queries_, *map_, rows, newest, window_began_);
    report.work.scanned = looks.scanned;
    report.work.sketches = looks.closely;
  }
  if (config_.decision == Decision::probability) {
    if (readable) {
      unseen_ = 0;
      report.work.sketches +=
          belief_.observe({&queries_, map_, &proposals_, newest, window_began_, rows},
                          pending_.chance_of_return(newest));
    } else {
      lose_sight(true);
    }
  }
  report.gate = readable ? Gate::warming_up : Gate::frame_error;
  if (report.newest >= window_began_ + after_centre) report.frame = report.newest - after_centre;
  const bool whole = report.newest >= window_began_ + config_.sequence_length;
  if (!whole && !relocalises(config_)) return report;

  report.full_search = choose_candidates(newest, rows);
  report.work.distances += budget_.distances();
  if (!whole) return report;
  for (const CandidateRun run : budget_.runs()) {
    report.work.line_sums +=
        search_.score(slices_, map_->order(), report.newest - config_.sequence_length, run, rows);
  }
  const bool keep_runner_up = report.full_search || relocalises(config_);
  const auto best = decision_.decide(map_->order(), search_.scores(), budget_.runs(),
                                     keep_runner_up, proposals_.proposals(), rows);
  if (best) report.work.candidates = best->scored;
  if (readable) decide(report, best);
  if (best && config_.decision == Decision::probability) {
    std::array<FoundLine, PendingAnswers::lines_kept> lines;
    const std::size_t count = lowest_lines(search_, map_->order(), budget_.runs(), *best, lines);
    const bool has_sessions = map_->order().newest_session().first > 0;
    for (FoundLine& line : std::span(lines).first(has_sessions ? count : 0)) {
      line.may_be_here = belief_.is_likeliest_of_session(*map_, ahead_of(line.row, line.line));
    }
    pending_.found(*report.frame, std::span(lines).first(count));
    expect_next(*best, rows, newest);
  }

  // Update: what the next frame starts from.
  double change = 1.0;
  if (config_.candidates == Candidates::adaptive) {
    change = change_degree_.advance(queries_, *report.frame);
    report.work.distances += change_degree_.distances();
  }
  ranges_.update(search_.scores(), budget_.runs(), best ? std::optional(best->row) : std::nullopt,
                 change);
  return report;
}

/// Where the robot is believed to be, the newest frame tells how far to the side it drives. Where
/// it was found lately that is known, and a place that it is less sure of may be another one that
/// looks like it from elsewhere, unless it has come to where its way leads: then it has changed
/// lanes.
/// @return distances that were computed
std::size_t Detector::learn_shift() noexcept {
  constexpr double sure = 2.0;
  const auto& likeliest = belief_.likeliest();
  if (!likeliest || belief_.new_place() >= 0.5) {
    shift_.learn_nothing();
    return 0;
  }
  const Evidence& evidence = *pending_.evidence();
  const bool is_sure = log_odds(evidence) - evidence.asked >= sure;
  const bool is_off_its_way = pending_.found_lately(queries_.newest()) > 0.0 &&
                              !pending_.leads_to(map_->order(), queries_.newest(), likeliest->row);
  if (!is_sure && is_off_its_way) return 0;
  return shift_.learn(queries_, standardised_, *map_, likeliest->row,
                      belief_.newest_novelty() * logistic(evidence.odds));
}

/// How many steps so many frames are that nothing is seen of.
std::uint64_t Detector::steps_of(std::uint64_t frames) noexcept {
  return told_.empty() ? frames : keyframes_.skip(frames);
}

/// The newest frame shows nothing: the robot may stand, or drive on. How far it has come is known
/// less and less well, so after a window of such frames the rows stay.
/// @param is_step whether it is a step of its own
void Detector::lose_sight(bool is_step) noexcept {
  const std::uint64_t steps = is_step ? steps_of(1) : 1;
  unseen_ += steps;
  if (steps > 0 && unseen_ <= config_.sequence_length) {
    belief_.drift(*map_, is_step);
  } else if (is_step) {
    belief_.pass(map_->order(), 1, 0);
  }
}

void Detector::skip(std::uint64_t frames) noexcept {
  if (frames == 0 || queries_.frames() == 0) return;
  const std::uint64_t most = config_.sequence_length + 1;
  skipped_ = std::min(most, skipped_ + std::min(most, frames));
  if (skipped_ == most) {
    restart();
    return;
  }
  const std::uint64_t steps = steps_of(frames);
  if (may_be_no_steps()) {
    hold_back(frames, steps);
    return;
  }
  steps_.skip(frames);
  if (steps > 0) newest_was_seen_ = false;
  pass(steps, frames);
}

/// Whether the next frame that can be read tells what those before it are that nothing is seen of:
/// where the robot stood with the newest one that could be read, or it usually takes more than one
/// to see something new.
bool Detector::may_be_no_steps() const noexcept {
  return !told_.empty() && newest_was_seen_ &&
         (keyframes_.is_dense() || steps_.repeats(queries_.newest()));
}

/// @param steps that the frames are if the next one shows something new
void Detector::hold_back(std::uint64_t frames, std::uint64_t steps) noexcept {
  held_back_.frames += frames;
  held_back_.steps += steps;
  steps_.skip(frames);
}

/// The first frame that can be read behind those that were held back, if any, shows something new:
/// the robot has gone on. Where they are more than a window before them and one behind them, nobody
/// knows how far.
void Detector::let_go(const HeldBack& held_back) noexcept {
  if (held_back.steps > 2 * config_.sequence_length) {
    restart();
    return;
  }
  pass(held_back.steps, held_back.frames);
}

/// So many steps went by with the newest frames that nothing was seen of.
void Detector::pass(std::uint64_t steps, std::uint64_t frames) noexcept {
  pending_.forget_evidence();
  if (steps == 0) return;
  steps_.pass(steps, frames);
  for (std::uint64_t step = 0; step < steps; ++step) {
    queries_.push_again();
    slices_.repeat();
    if (config_.use == Use::close_loops) static_cast<void>(become_place());
  }
  ranges_.skip(map_->order(), steps);
  proposals_.skip(map_->order(), steps);
  decision_.skip(steps);
  if (config_.decision == Decision::probability) belief_.pass(map_->order(), steps, 1);
  change_degree_ = {};
}

void Detector::restart() noexcept {
  held_back_ = {};
  answered_.begin();
  believed_.begin();
  window_began_ = queries_.frames();
  newest_was_seen_ = false;
  ranges_.restart();
  proposals_.restart();
  decision_.restart();
  belief_.restart();
  pending_.forget_what_was_found();
  change_degree_ = {};
}

/// Takes the newest frame's descriptor: standardised by what the drive has shown so far, or that of
/// the frame before when there is nothing to take.
Detector::Taken Detector::take_query(std::span<const float> descriptor) noexcept {
  if (descriptor.size() != map_->descriptor_size() || !well_formed(descriptor, config_)) {
    if (may_be_no_steps()) {
      hold_back(1, steps_of(1));
      return {false, false};
    }
    steps_.take(true, FrameSteps::Shows::the_same);
    newest_was_seen_ = false;
    ++unread_;
    queries_.push_again();
    return {false, true};
  }
  unread_ = 0;
  if (!config_.standardisation.on) {
    steps_.take(true, FrameSteps::Shows::something_new);
    queries_.push(descriptor);
    return {true, true};
  }
  statistics_.follow(descriptor, config_.standardisation);
  const bool is_keyframe = told_.empty() || keyframes_.take(descriptor, statistics_.variance_sum());
  const HeldBack held_back = std::exchange(held_back_, {});
  if (!is_keyframe && newest_was_seen_) {
    steps_.repeat();
    if (config_.use == Use::close_loops && !keyframes_.is_dense()) stand(held_back.frames + 1);
    return {true, false};
  }
  let_go(held_back);
  using enum FrameSteps::Shows;
  steps_.take(keyframes_.is_settled(), !is_keyframe          ? the_same
                                       : keyframes_.is_cut() ? another_scene
                                                             : something_new);
  newest_was_seen_ = true;
  statistics_.standardise(descriptor, standardised_);
  queries_.push(standardised_, shift_.moved(standardised_));
  return {true, true};
}

/// The robot stood for so many frames at the newest place, if that is the newest step.
void Detector::stand(std::uint64_t frames) noexcept {
  const PlaceOrder& order = map_->order();
  const CandidateRun drive = running(config_, order);
  if (drive.first < drive.last &&
      order.frame(drive.last - 1) == steps_.frame_of(queries_.newest())) {
    map_->stand(frames);
  }
}

/// Closing loops: the newest frame becomes a place, if the map has room or makes some.
bool Detector::become_place() noexcept {
  // Places that the newest frames still need as they were: those that are no candidates yet.
  const std::size_t keep = std::max(keep_.value_or(0), config_.exclude + config_.sequence_length);
  const std::uint64_t frame = steps_.frame_of(queries_.newest());
  // The numbers of frames that are no keyframes are left out.
  if (queries_.newest() > 0) {
    const std::uint64_t apart = frame - steps_.frame_of(queries_.newest() - 1);
    map_->count_from(map_->order().next_number() + apart - 1);
  }
  // A lens that stays covered does not fill the map, nor does a robot that stands.
  if (!told_.empty() && unread_ > config_.sequence_length) {
    map_->count_from(map_->order().next_number() + 1);
    return true;
  }
  const PlaceMap::Taken taken =
      map_->take(queries_.rows(), queries_.row_of(queries_.newest()), frame, keep);
  // A frame that finds no room has a number all the same.
  if (!taken.slot) map_->count_from(map_->order().next_number() + 1);
  // Several frames may come before who needs the newest places hears of them.
  if (taken.slot && keep_) ++*keep_;
  if (taken.removed) {
    slices_.forget(*taken.slot);
    ranges_.removed(*taken.removed);
    proposals_.removed(*taken.removed);
    decision_.removed(*taken.removed);
    belief_.removed(*taken.removed, taken.forgotten);
    pending_.removed(*taken.removed, taken.forgotten);
  }
  return taken.slot.has_value();
}

bool Detector::take_in(std::size_t session, const PlaceMap::Saved& place) noexcept {
  const std::optional<std::size_t> row = map_->add_saved_to(session, place);
  if (!row) return false;
  belief_.taken_in(map_->capacity());
  if (*row + 1 == map_->size()) return true;
  ranges_.inserted(*row);
  proposals_.inserted(*row);
  decision_.inserted(*row);
  belief_.inserted(*row);
  pending_.inserted(*row);
  return true;
}

/// Rows of the map that lines may touch when a frame is matched: those of earlier sessions, and the
/// places of the running drive that are old enough.
std::size_t Detector::rows_searched(std::uint64_t centre) const noexcept {
  const CandidateRun drive = running(config_, map_->order());
  if (centre <= config_.exclude || drive.first == drive.last) return drive.first;
  return map_->order().row_of_frame(steps_.frame_of(centre - config_.exclude));
}

/// Rows whose neighbourhood is all there, so that what is enhanced by it stays right.
std::size_t Detector::complete_rows() const noexcept {
  const CandidateRun drive = running(config_, map_->order());
  const std::size_t reach =
      config_.enhance && map_->size() < map_->capacity() ? config_.rwindow / 2 : 0;
  return drive.last - std::min(drive.last - drive.first, reach);
}

/// Where all rows are candidates, every difference that a frame can be asked for while it is in the
/// window will be: computing them as it arrives spreads the work evenly. Where loops are closed
/// onto the window itself, a column grows by the place that has just been added.
std::size_t Detector::fill_columns(std::uint64_t newest) noexcept {
  if (config_.candidates != Candidates::all) return 0;
  std::uint64_t frame =
      std::max(window_began_, newest - std::min<std::uint64_t>(newest, config_.sequence_length));
  const std::size_t complete = complete_rows();
  std::size_t computed = 0;
  for (; frame <= newest; ++frame) {
    const std::size_t rows = rows_searched(frame + trajectories_.centre());
    computed += slices_.fill(*map_, frame, 0, std::min(rows, complete));
  }
  return computed;
}

/// Decides which rows the centre frame is compared with, and computes their differences.
/// @return whether they are all
bool Detector::choose_candidates(std::uint64_t newest, std::size_t rows) noexcept {
  const CandidateBudget::Window window{&slices_,      map_,       &trajectories_,
                                       window_began_, newest + 1, rows};
  const std::span<const CandidateRun> ranges = ranges_.choose(map_->order(), rows);
  const std::span<const CandidateProposals::Proposal> proposals = proposals_.proposals();
  budget_.clear();
  // Where the robot is believed to be comes before all.
  if (const auto& likeliest = belief_.likeliest(); likeliest && relocalises(config_)) {
    const std::size_t after = trajectories_.window() - 1 - trajectories_.centre();
    const std::size_t centre = map_->order().before(likeliest->row, after);
    budget_.add(window, ranges_.around(map_->order(), centre, rows));
  }
  // The best of both first, so that neither starves.
  for (std::size_t i = 0; i < std::max(ranges.size(), proposals.size()); ++i) {
    if (i < ranges.size()) budget_.add(window, ranges[i]);
    if (i < proposals.size())
      budget_.add(window, ranges_.around(map_->order(), proposals[i].centre, rows));
  }
  return ranges_.full_search();
}

/// The row at the newest frame of a line through a row at the centre.
std::size_t Detector::ahead_of(std::size_t row, std::size_t line) const noexcept {
  return row + static_cast<std::size_t>(trajectories_.offsets(line).back());
}

std::size_t Detector::ahead_of(const BestRow& best) const noexcept {
  return ahead_of(best.row, search_.line(best.row));
}

/// Where the best line leads, the robot may be with the next frame: if it was found lately, for in
/// a map of somewhere else there is always a best line, too.
void Detector::expect_next(const BestRow& best, std::size_t rows, std::uint64_t newest) noexcept {
  const std::size_t next = ahead_of(best) + 1;
  const bool goes_on = next < rows && map_->order().apart(best.row, next) == next - best.row;
  if (!goes_on || pending_.found_lately(newest) <= 0.0) return;
  belief_.expect(next, best.uniqueness);
}

/// Names the gate, and the line behind the best row.
void Detector::decide(FrameReport& report, const std::optional<BestRow>& best) const noexcept {
  if (!best) {
    report.gate = Gate::no_candidate;
    return;
  }
  const auto number = [&](std::size_t row) { return map_->order().number(row); };
  report.match = Match{number(best->row),
                       static_cast<float>(best->score),
                       static_cast<float>(best->uniqueness),
                       trajectories_.velocity(search_.line(best->row)),
                       number(ahead_of(*best)),
                       best->runner_up ? std::optional(number(*best->runner_up)) : std::nullopt};
  const bool unique = report.match->uniqueness <= config_.max_uniqueness;
  report.gate = unique ? Gate::match : Gate::not_unique;
}

}  // namespace seqloop
