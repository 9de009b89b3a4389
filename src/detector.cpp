#include "seqloop/detector.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "seqloop/difference.hpp"

namespace seqloop {
namespace {

const MatcherConfig& checked(const MatcherConfig& config, const PlaceMap& map) {
  Faults faults = validate(config);
  if (config.use == Use::localise && map.size() == 0) {
    faults.push_back(
        {"map", "it has no places", "add the reference drive before localising in it"});
  }
  if (config.use == Use::close_loops && map.size() != 0) {
    faults.push_back({"map", "it holds " + std::to_string(map.size()) + " places already",
                      "closing loops starts from an empty map"});
  }
  if (config.use == Use::localise && map.size() != 0 &&
      config.standardisation.on != (map.statistics().frames() != 0)) {
    faults.push_back({"map",
                      config.standardisation.on ? "its places were not standardised"
                                                : "its places were standardised",
                      "standardise both the map and the query, or neither"});
  }
  if (!faults.empty()) throw SetupError(std::move(faults));
  return config;
}

Capacity capacity_of(const PlaceMap& map) { return {map.capacity(), map.descriptor_size()}; }

/// Query descriptors that must be kept: the window's, and what the change degree of its centre
/// looks back on.
std::size_t history(const MatcherConfig& config) {
  const std::size_t ds = config.sequence_length;
  return std::max(ds + 1, ds - ds / 2 + ChangeDegree::reach + 1);
}

/// Whether a descriptor is what its difference wants: finite, and for Euclid of unit length
/// (Algorithm 1) or all zero. One that is not would spoil the running statistics for the rest of
/// the drive.
bool well_formed(std::span<const float> values, const MatcherConfig& config) {
  if (blank(config.difference, values)) return !config.blank_is_unreadable;
  const double squares = squared_norm(values);
  if (config.difference == Difference::mean_absolute) return std::isfinite(squares);
  constexpr double tolerance = 0.01;
  return std::abs(squares - 1.0) <= tolerance;
}

}  // namespace

std::vector<BufferSize> Detector::plan(const MatcherConfig& config, const Capacity& capacity) {
  Faults faults = validate(config);
  for (Fault& fault : validate(capacity)) faults.push_back(std::move(fault));
  if (!faults.empty()) throw SetupError(std::move(faults));
  std::vector<BufferSize> buffers;
  const Detector measured(Arena(buffers), config, nullptr, capacity, ArenaMemory());
  return buffers;
}

Work Detector::most_work(const MatcherConfig& config, const Capacity& capacity) {
  const std::size_t window = config.sequence_length + 1;
  const std::size_t lines =
      velocity_range(config.sequence_length, config.vmin, config.vmax).count();
  // Where all rows are candidates, a column is computed as its frame arrives. In a growing map, a
  // column that repeats another (`skip`) has as many rows more to look at as it is younger, and
  // columns that reach the newest places grow with them. Elsewhere a full search finds the whole
  // window empty.
  std::size_t distances = capacity.places;
  if (config.candidates != Candidates::all) {
    distances *= window;
  } else if (config.use == Use::close_loops) {
    const std::size_t ds = config.sequence_length;
    const std::size_t reach = ds / 2 + (config.enhance ? config.rwindow / 2 : 0);
    const std::size_t growing = reach - std::min(reach, config.exclude);
    distances += ds * (ds + 1) / 2 + (ds + growing) * growing;
  }
  if (config.candidates == Candidates::adaptive) distances += ChangeDegree::reach;
  return {capacity.places, distances, capacity.places * lines};
}

Detector::Detector(const MatcherConfig& config, PlaceMap& map, std::span<std::byte> memory)
    : Detector(config, map,
               ArenaMemory(bytes_needed(checked(config, map), capacity_of(map)), memory)) {}

Detector::Detector(const MatcherConfig& config, PlaceMap& map, ArenaMemory&& memory)
    : Detector(Arena(memory.span()), config, &map, capacity_of(map), std::move(memory)) {
  statistics_.start_from(map.statistics(), config.standardisation.prior_frames);
}

Detector::Detector(Arena arena, const MatcherConfig& config, PlaceMap* map,
                   const Capacity& capacity, ArenaMemory&& memory)
    : memory_(std::move(memory)),
      config_(config),
      map_(map),
      trajectories_(arena, config.sequence_length, config.vmin, config.vmax),
      statistics_(arena, capacity.descriptor_size),
      slices_(arena, config, history(config), capacity),
      search_(arena, trajectories_, capacity.places),
      ranges_(arena, config),
      decision_(config.rwindow) {}

FrameReport Detector::step(std::span<const float> descriptor) noexcept {
  FrameReport report;
  report.newest = slices_.frames();
  report.k = ranges_.k();
  const std::size_t after_centre = config_.sequence_length - trajectories_.centre();

  const bool readable = take_query(descriptor);
  if (config_.use == Use::close_loops)
    report.map_full = !map_->add(newest_query().first(map_->descriptor_size()));
  report.work.distances = fill_columns();
  report.gate = readable ? Gate::warming_up : Gate::frame_error;
  if (report.newest >= window_began_ + after_centre) report.frame = report.newest - after_centre;
  if (report.newest < window_began_ + config_.sequence_length) return report;

  const std::uint64_t oldest = report.newest - config_.sequence_length;
  const std::size_t rows = rows_searched(*report.frame);
  const std::span<const CandidateRun> runs = ranges_.choose(rows);
  report.full_search = ranges_.full_search();
  for (const CandidateRun run : runs) {
    report.work.distances += fill_window(oldest, run, rows);
    report.work.line_sums += search_.score(slices_, oldest, run, rows);
  }
  const auto best = decision_.decide(search_.scores(), runs, report.full_search);
  if (best) report.work.candidates = best->scored;
  if (readable) decide(report, best);

  // Update: what the next frame starts from.
  double change = 1.0;
  if (config_.candidates == Candidates::adaptive) {
    change = change_degree_.advance(slices_, *report.frame);
    report.work.distances += change_degree_.distances();
  }
  ranges_.update(search_.scores(), best ? std::optional(best->row) : std::nullopt, change);
  return report;
}

void Detector::skip(std::uint64_t frames) noexcept {
  if (frames == 0 || slices_.frames() == 0) return;
  if (frames > config_.sequence_length) {
    restart();
    return;
  }
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    slices_.repeat();
    if (config_.use == Use::close_loops) {
      static_cast<void>(map_->add(newest_query().first(map_->descriptor_size())));
    }
  }
  ranges_.skip(frames);
  change_degree_ = {};
}

void Detector::restart() noexcept {
  window_began_ = slices_.frames();
  ranges_.restart();
  change_degree_ = {};
}

/// Puts the newest frame's descriptor into its column: standardised by what the drive has shown so
/// far, or a copy of the frame before when there is nothing to put.
bool Detector::take_query(std::span<const float> descriptor) noexcept {
  const std::uint64_t frame = slices_.frames();
  const std::span<float> query = slices_.push();
  if (descriptor.size() != map_->descriptor_size() || !well_formed(descriptor, config_)) {
    if (frame == 0) {
      std::ranges::fill(query, 0.0F);
    } else {
      std::ranges::copy(slices_.query(frame - 1), query.begin());
    }
    return false;
  }
  if (config_.standardisation.on) {
    if (statistics_.frames() == 0) {
      statistics_.start_flat(descriptor, config_.standardisation.prior_frames);
    }
    statistics_.follow(descriptor, config_.standardisation.horizon);
    statistics_.standardise(descriptor, query);
  } else {
    std::ranges::copy(descriptor, query.begin());
  }
  return true;
}

/// Rows of the map that lines may touch when a frame is matched.
std::size_t Detector::rows_searched(std::uint64_t centre) const noexcept {
  if (config_.use == Use::localise) return map_->size();
  if (centre <= config_.exclude) return 0;
  return static_cast<std::size_t>(std::min<std::uint64_t>(centre - config_.exclude, map_->size()));
}

/// Rows whose neighbourhood is all there, so that what is enhanced by it stays right.
std::size_t Detector::complete_rows() const noexcept {
  const bool growing = config_.use == Use::close_loops && map_->size() < map_->capacity();
  const std::size_t reach = config_.enhance && growing ? config_.rwindow / 2 : 0;
  return map_->size() - std::min(map_->size(), reach);
}

/// Where all rows are candidates, every difference that a frame can be asked for while it is in the
/// window will be: computing them as it arrives spreads the work evenly. Where loops are closed
/// onto the window itself, a column grows by the place that has just been added.
std::size_t Detector::fill_columns() noexcept {
  if (config_.candidates != Candidates::all) return 0;
  const std::uint64_t newest = slices_.frames() - 1;
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

/// Computes what lines through the run can touch.
std::size_t Detector::fill_window(std::uint64_t oldest, CandidateRun run,
                                  std::size_t rows) noexcept {
  std::size_t computed = 0;
  const auto first_row = static_cast<std::int64_t>(run.first);
  const auto last_row = static_cast<std::int64_t>(run.last);
  for (std::size_t i = 0; i < trajectories_.window(); ++i) {
    const auto first = std::max<std::int64_t>(first_row + trajectories_.lowest(i), 0);
    const auto last =
        std::min(last_row + trajectories_.highest(i), static_cast<std::int64_t>(rows));
    if (first >= last) continue;
    computed += slices_.fill(*map_, oldest + i, static_cast<std::size_t>(first),
                             static_cast<std::size_t>(last));
  }
  return computed;
}

/// Names the gate, and the line behind the best row.
void Detector::decide(FrameReport& report, const std::optional<BestRow>& best) const noexcept {
  if (!best) {
    report.gate = Gate::no_candidate;
    return;
  }
  const std::size_t line = search_.line(best->row);
  const auto ahead = static_cast<std::size_t>(trajectories_.offsets(line).back());
  report.match = Match{best->row, best->score, best->uniqueness, trajectories_.velocity(line),
                       best->row + ahead};
  const bool unique = best->uniqueness <= config_.max_uniqueness;
  report.gate = unique ? Gate::match : Gate::not_unique;
}

}  // namespace seqloop
