// SPDX-License-Identifier: MIT
#include "program/fleet/fleet.hpp"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "program/fleet/fleet_talk.hpp"
#include "program/run/frame_json.hpp"
#include "program/run/source_numbers.hpp"

namespace seqloop::program {
namespace {

// Places that are taken in before a frame, at most.
constexpr std::size_t most_a_frame = 64;

// Numbers that a session's places may have.
constexpr std::uint64_t numbers = most_fleet_places;

constexpr std::uint32_t none = ~std::uint32_t{0};

/// The drive is localised among others' places. None of them goes; but they come in any order, and
/// search has room for that only where some might.
MatcherConfig fleet_config(MatcherConfig config) {
  config.use = Use::localise;
  config.full_map = FullMap::forget_oldest;
  return config;
}

}  // namespace

class Fleet::Impl {
 public:
  Impl(const FleetSettings& settings, std::shared_ptr<dds::Participant> participant,
       LastingMap& map, const MatcherConfig& config, const PlaceMap& own)
      : participant_(std::move(participant)),
        map_(fleet_config(config), {settings.places, own.descriptor_size(), Others::most_sessions}),
        detector_((start_as(own), fleet_config(config)), map_),
        numbers_(fleet_config(config), nullptr),
        begun_(Others::most_sessions, none),
        heard_of_(Others::most_sessions, none),
        talk_(settings, *participant_, map) {}

  void step(ProcessedFrame& processed, Clock& clock) noexcept {
    answers_ = {};
    if (processed.report.gate == Gate::no_frame) return;
    const Nanoseconds before = clock.now();
    take_in();
    detector_.skip(processed.frame.lost + processed.frame.dropped);
    ProcessedFrame mine;
    mine.frame = processed.frame;
    mine.report = detector_.step(processed.descriptor);
    numbers_.rename(mine);
    answers_ = mine.report.answers;
    const Nanoseconds took = clock.now() - before;
    processed.times.match += took;
    processed.times.total += took;
    for (const Answer& answer : answers_) note(answer);
  }

  void finish() noexcept {
    answers_ = numbers_.rename(detector_.finish());
    for (const Answer& answer : answers_) note(answer);
  }

  void add_to(nlohmann::ordered_json& frame) const {
    frame["fleet_places"] = map_.size();
    nlohmann::ordered_json& all = frame["fleet"];
    if (!all.is_array()) all = nlohmann::ordered_json::array();
    for (const Answer& answer : answers_) {
      nlohmann::ordered_json json = answer_json(answer);
      // Numbers of this run's own.
      json.erase("match");
      json.erase("head");
      for (const char* key : {"robot", "session", "session_frame"}) json[key] = nullptr;
      if (answer.match) {
        const PlaceOrder& order = map_.order();
        const Others::Names& names =
            talk_.names(heard_of_[order.session_of_number(answer.match->place)]);
        json["robot"] = names.robot;
        json["session"] = names.session;
        json["session_frame"] = order.frame(*order.row_of_number(answer.match->place));
      }
      all.push_back(std::move(json));
    }
  }

  [[nodiscard]] std::optional<std::string> trouble() { return talk_.news(); }

  [[nodiscard]] std::string end() {
    talk_.end();
    const FleetTalk::Counts counts = talk_.counts();
    std::string text = fmt::format(
        "{} places were told; of others {} places of {} sessions are known, and {} "
        "frames closed loops with them",
        counts.told, counts.heard, counts.sessions, loops_);
    if (counts.untold > 0) {
      text += fmt::format("; {} were not told, for the network was too slow", counts.untold);
    }
    if (refused_ > 0) text += fmt::format("; {} of others' are none that can be", refused_);
    return text;
  }

 private:
  /// Frames are standardised as those of the run are.
  void start_as(const PlaceMap& own) {
    const RunningStatistics& known = own.statistics();
    if (known.frames() == 0) return;
    const std::vector<double> mean(known.mean().begin(), known.mean().end());
    const std::vector<double> variance(known.variance().begin(), known.variance().end());
    static_cast<void>(map_.set_statistics(mean, variance, known.frames()));
  }

  void take_in() noexcept {
    for (std::size_t i = 0; i < most_a_frame; ++i) {
      const PlaceQueue::Place* const place = talk_.heard().front();
      if (place == nullptr) return;
      if (place->visited) {
        link(*place);
      } else if (!take_in(*place)) {
        ++refused_;
      }
      talk_.heard().pop();
    }
  }

  [[nodiscard]] bool take_in(const PlaceQueue::Place& place) noexcept {
    std::uint32_t& session = begun_[place.session];
    const bool is_new = session == none;
    if (is_new) {
      map_.count_from(used_ * numbers);
      if (!map_.begin_session()) return false;
    }
    const std::uint32_t row_session = is_new ? used_ : session;
    const CandidateRun rows = map_.order().session(row_session);
    const std::uint64_t number = row_session * numbers + (rows.last - rows.first);
    if (!detector_.take_in(row_session, {number, place.frame, place.bytes})) return false;
    if (is_new) {
      session = used_;
      heard_of_[used_++] = place.session;
    }
    return true;
  }

  void note(const Answer& answer) noexcept {
    if (answer.gate == Gate::match) ++loops_;
    // As within a map, for later frames of all.
    constexpr float likely = 0.9F;
    if (!answer.match || !(answer.probability >= likely)) return;
    const PlaceOrder& order = map_.order();
    const auto row = order.row_of_number(answer.match->place);
    if (!row) return;
    talk_.found({answer.frame, heard_of_[order.session_of(*row)], order.frame(*row)});
  }

  /// The row of a frame of a session. Work: log N.
  [[nodiscard]] std::optional<std::size_t> row_of(std::uint32_t session,
                                                  std::uint64_t frame) const noexcept {
    if (begun_[session] == none) return std::nullopt;
    CandidateRun rows = map_.order().session(begun_[session]);
    const std::size_t end = rows.last;
    while (rows.first < rows.last) {
      const std::size_t middle = rows.first + (rows.last - rows.first) / 2;
      if (map_.order().frame(middle) < frame) {
        rows.first = middle + 1;
      } else {
        rows.last = middle;
      }
    }
    if (rows.first == end || map_.order().frame(rows.first) != frame) return std::nullopt;
    return rows.first;
  }

  /// Two rows are one place, and do not compete.
  void link(const PlaceQueue::Place& place) noexcept {
    const auto row = row_of(place.session, place.frame);
    const auto visited = row_of(place.visited->session, place.visited->frame);
    if (row && visited) map_.set_first_visit(*row, map_.first_visit(*visited));
  }

  std::shared_ptr<dds::Participant> participant_;
  PlaceMap map_;
  Detector detector_;
  SourceNumbers numbers_;
  std::vector<std::uint32_t> begun_;     // by session as it was heard: which of the map, or `none`
  std::vector<std::uint32_t> heard_of_;  // by session of the map: as it was heard
  std::uint32_t used_ = 0;
  std::span<const Answer> answers_;
  std::uint64_t loops_ = 0;
  std::uint64_t refused_ = 0;
  FleetTalk talk_;
};

Fleet::Fleet(const FleetSettings& settings, std::shared_ptr<dds::Participant> participant,
             LastingMap& map, const MatcherConfig& config, const PlaceMap& own)
    : impl_(std::make_unique<Impl>(settings, std::move(participant), map, config, own)) {}

Fleet::~Fleet() = default;

void Fleet::step(ProcessedFrame& processed, Clock& clock) noexcept {
  impl_->step(processed, clock);
}

void Fleet::finish() noexcept { impl_->finish(); }

void Fleet::add_to(nlohmann::ordered_json& frame) const { impl_->add_to(frame); }

std::optional<std::string> Fleet::trouble() { return impl_->trouble(); }

std::string Fleet::end() { return impl_->end(); }

}  // namespace seqloop::program
