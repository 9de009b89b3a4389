// SPDX-License-Identifier: MIT
#include "evaluation/truth.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "seqloop/fault.hpp"

namespace seqloop::evaluation {
namespace {

double northing(const Positions::Place& place) { return place.point.back(); }

bool within(const Positions::Place& a, const Positions::Place& b, double most) {
  double squares = 0.0;
  for (std::size_t axis = 0; axis < a.point.size(); ++axis) {
    const double apart = a.point[axis] - b.point[axis];
    squares += apart * apart;
  }
  return squares <= most * most;
}

/// Frames of the places that are near enough, ascending.
/// @param sorted by northing
std::vector<std::uint64_t> frames_near(const std::vector<Positions::Place>& sorted,
                                       const Positions::Place& here, double most) {
  std::vector<std::uint64_t> frames;
  auto place = std::ranges::lower_bound(sorted, northing(here) - most, {}, northing);
  for (; place != sorted.end() && northing(*place) <= northing(here) + most; ++place) {
    if (within(*place, here, most)) frames.push_back(place->frame);
  }
  std::ranges::sort(frames);
  return frames;
}

/// The radius along a straight line, as positions are compared. Throws SetupError: it is none.
double most_apart(double radius_m, bool on_earth) {
  if (!(radius_m > 0.0 && std::isfinite(radius_m))) {
    throw SetupError(Fault{"radius", "it must be above 0 metres"});
  }
  return on_earth ? chord(radius_m) : radius_m;
}

}  // namespace

Truth Truth::identity(std::uint64_t frames) {
  Truth truth;
  truth.identity_frames_ = frames;
  return truth;
}

Truth Truth::laps(std::uint64_t frames, std::uint64_t laps) {
  Truth truth;
  for (std::uint64_t query = frames; query < frames * laps; ++query) {
    std::vector<Run>& runs = truth.places_[query];
    for (std::uint64_t place = query % frames; place < query; place += frames) {
      runs.push_back({place, place});
    }
  }
  return truth;
}

Truth Truth::from_csv(const CsvTable& table, Unlisted unlisted) {
  const std::vector<std::size_t> columns = table.columns({"query", "reference"});
  const std::optional<std::size_t> tolerance = table.find("tolerance");
  Truth truth;
  truth.unlisted_ = unlisted;
  std::size_t own = 0;
  table.for_each_row([&](CsvRow& row) {
    const std::uint64_t query = row.whole(columns[0]);
    const std::uint64_t place = row.whole(columns[1]);
    Run run{place, place};
    if (tolerance && !row.empty(*tolerance)) {
      run.tolerance = row.whole(*tolerance);
      ++own;
    }
    truth.places_[query].push_back(run);
  });
  if (truth.places_.empty()) {
    throw SetupError({table.name(), "it has no rows", "--truth no-revisit if nothing comes back"});
  }
  if (own > 0) {
    truth.own_tolerances_ = own == table.rows() ? OwnTolerances::all : OwnTolerances::some;
  }
  return truth;
}

Truth Truth::from_positions(Positions reference, const Positions& query, double radius_m,
                            Unlisted unlisted) {
  const double most = most_apart(radius_m, query.on_earth);
  if (reference.on_earth != query.on_earth) {
    throw SetupError({"reference-positions, query-positions",
                      "one has x,y and the other latitude,longitude", "give both alike"});
  }
  std::ranges::sort(reference.places, {}, northing);
  Truth truth;
  truth.unlisted_ = unlisted;
  truth.known_ = frames_of(reference);
  for (const Positions::Place& here : query.places) {
    truth.places_[here.frame] = runs_of(frames_near(reference.places, here, most));
  }
  if (truth.frames() == 0) {
    throw SetupError({"radius", "no query frame is that near to a reference frame",
                      "widen it, or check that both drives use the same coordinates"});
  }
  return truth;
}

Truth Truth::loops_from_positions(const Positions& drive, double radius_m, Unlisted unlisted) {
  const double most = most_apart(radius_m, drive.on_earth);
  std::vector<Positions::Place> by_northing = drive.places;
  std::ranges::sort(by_northing, {}, northing);
  std::vector<Positions::Place> driven = drive.places;
  std::ranges::sort(driven, {}, &Positions::Place::frame);
  Truth truth;
  truth.unlisted_ = unlisted;
  truth.known_ = frames_of(drive);
  for (auto here = driven.begin(); here != driven.end(); ++here) {
    auto came = here;  // the robot has been near since then
    while (came != driven.begin() && within(*std::prev(came), *here, most)) --came;
    std::vector<std::uint64_t> frames = frames_near(by_northing, *here, most);
    frames.erase(std::ranges::lower_bound(frames, came->frame), frames.end());
    truth.places_[here->frame] = runs_of(frames);
  }
  if (truth.frames() == 0) {
    throw SetupError({"radius", "no frame comes back that near to where the robot had been",
                      "widen it, or give the truth no-revisit if nothing comes back"});
  }
  return truth;
}

std::set<std::uint64_t> Truth::frames_of(const Positions& positions) {
  std::set<std::uint64_t> frames;
  for (const Positions::Place& place : positions.places) frames.insert(place.frame);
  return frames;
}

std::vector<Truth::Run> Truth::runs_of(std::span<const std::uint64_t> frames) {
  std::vector<Run> runs;
  for (const std::uint64_t frame : frames) {
    if (!runs.empty() && runs.back().last + 1 == frame) {
      runs.back().last = frame;
    } else {
      runs.push_back({frame, frame, 0});
    }
  }
  return runs;
}

std::uint64_t Truth::frames() const noexcept {
  if (identity_frames_) return *identity_frames_;
  return static_cast<std::uint64_t>(
      std::ranges::count_if(places_, [](const auto& listed) { return !listed.second.empty(); }));
}

std::uint64_t Truth::queries_reach() const noexcept {
  if (identity_frames_) return *identity_frames_;
  return places_.empty() ? 0 : places_.rbegin()->first + 1;
}

std::uint64_t Truth::places_reach() const noexcept {
  if (identity_frames_) return *identity_frames_;
  std::uint64_t reach = 0;
  for (const auto& [query, runs] : places_) {
    for (const Run& run : runs) reach = std::max(reach, run.last + 1);
  }
  return reach;
}

bool Truth::right(std::uint64_t query, std::uint64_t match,
                  std::uint64_t tolerance) const noexcept {
  const auto near = [&](const Run& run) {
    const std::uint64_t allowed = run.tolerance.value_or(tolerance);
    if (match < run.first) return run.first - match <= allowed;
    return match <= run.last || match - run.last <= allowed;
  };
  if (identity_frames_) return query < *identity_frames_ && near({query, query});
  const auto found = places_.find(query);
  return found != places_.end() && std::ranges::any_of(found->second, near);
}

}  // namespace seqloop::evaluation
