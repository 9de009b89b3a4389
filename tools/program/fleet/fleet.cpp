// SPDX-License-Identifier: MIT
#include "program/fleet/fleet.hpp"

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "program/drives/source_numbers.hpp"
#include "program/fleet/fleet_talk.hpp"
#include "program/fleet/others_map.hpp"
#include "program/fleet/through_own.hpp"
#include "program/run/frame_json.hpp"
#include "seqloop/detail/counted.hpp"

namespace seqloop::program {
namespace {

// Places that are taken in before a frame, at most.
constexpr std::size_t most_a_frame = 64;

// Loops that become known at once and are handed on, at most.
constexpr std::size_t most_loops = 1024;

}  // namespace

class Fleet::Impl {
 public:
  Impl(const FleetSettings& settings, std::shared_ptr<dds::Participant> participant,
       LastingMap& map, const MatcherConfig& config, const PlaceMap& own)
      : participant_(std::move(participant)),
        map_(config, settings.places, most_fleet_sessions, own),
        through_own_(config, own),
        numbers_(config, nullptr),
        novel_(settings.novel),
        talk_(settings, *participant_, map) {
    loops_.reserve(most_loops);
  }

  void step(ProcessedFrame& processed, Clock& clock) noexcept {
    answers_ = {};
    loops_.clear();
    if (processed.report.gate == Gate::no_frame) return;
    const Nanoseconds before = clock.now();
    take_in();
    ProcessedFrame mine;
    mine.frame = processed.frame;
    mine.report = map_.step(processed.descriptor, processed.frame.lost + processed.frame.dropped);
    const std::span<const Answer> both =
        through_own_.take(processed.report.answers, mine.report.answers);
    numbers_.rename(mine);
    link(mine.report.answers);
    link_own(processed.report.answers);
    close(numbers_.rename(both));
    const Nanoseconds took = clock.now() - before;
    processed.times.match += took;
    processed.times.total += took;
  }

  void finish(std::span<const Answer> rest) noexcept {
    loops_.clear();
    const std::span<const Answer> last = map_.finish();
    const std::span<const Answer> both = through_own_.finish(rest, last);
    link(numbers_.rename(last));
    link_own(rest);
    close(numbers_.rename(both));
  }

  [[nodiscard]] std::span<const OtherLoop> loops() const noexcept { return loops_; }
  [[nodiscard]] std::size_t places() const noexcept { return map_.size(); }

  void add_to(nlohmann::ordered_json& frame) const {
    frame["fleet_places"] = map_.size();
    nlohmann::ordered_json& all = frame["fleet"];
    if (!all.is_array()) all = nlohmann::ordered_json::array();
    for (const Answer& answer : answers_) {
      nlohmann::ordered_json json = answer_json(answer);
      // Numbers of this run's own.
      for (const char* key : {"match", "head", "runner_up"}) json.erase(key);
      for (const char* key : {"robot", "session", "session_frame"}) json[key] = nullptr;
      if (answer.match) {
        const OthersMap::Place place = map_.where(answer.match->place);
        const Others::Names& names = talk_.names(place.session);
        json["robot"] = names.robot;
        json["session"] = names.session;
        json["session_frame"] = place.frame;
      }
      all.push_back(std::move(json));
    }
  }

  [[nodiscard]] std::optional<std::string> trouble() { return talk_.news(); }

  [[nodiscard]] std::string end() {
    talk_.end();
    const FleetTalk::Counts counts = talk_.counts();
    std::string text =
        fmt::format("{} {} told; of others {} of {} {} known, and {} closed loops with them",
                    counted(counts.told, "place"), counts.told == 1 ? "was" : "were",
                    counted(counts.heard, "place"), counted(counts.sessions, "session"),
                    are(counts.heard), counted(closed_, "frame"));
    if (novel_) text += fmt::format("; {} were not told, being no novel ones", counts.known);
    if (counts.untold > 0) {
      text += fmt::format("; {} were not told, for the network or --fleet-kbps is too slow",
                          counts.untold);
    }
    if (refused_ > 0) text += fmt::format("; {} of others' are none that can be", refused_);
    return text;
  }

 private:
  void take_in() noexcept {
    for (std::size_t i = 0; i < most_a_frame; ++i) {
      const PlaceQueue::Place* const place = talk_.heard().front();
      if (place == nullptr) return;
      const OthersMap::Place at{place->session, place->frame};
      if (place->visited) {
        map_.same_place(at, {place->visited->session, place->visited->frame});
      } else if (!map_.take_in(at, place->bytes)) {
        ++refused_;
      }
      talk_.heard().pop();
    }
  }

  /// Others are told which frames are places of theirs. What follows from the robot's own loops,
  /// which they are told as well, follows for them, too.
  void link(std::span<const Answer> answers) noexcept {
    for (const Answer& answer : answers) {
      if (!likely(answer)) continue;
      const OthersMap::Place place = map_.where(answer.match->place);
      talk_.found({answer.frame, place.session, place.frame, {}});
    }
  }

  /// They are told at once, too, where the robot was at a place of its own: in the map's file that
  /// is only when all that follows is known, and until then its places contest each other.
  /// @param answers of the robot's own map
  void link_own(std::span<const Answer> answers) noexcept {
    for (const Answer& answer : numbers_.rename(answers)) {
      if (novel_) talk_.judged({answer.frame, answer.gate == Gate::match});
      if (likely(answer)) talk_.found({answer.frame, 0, 0, answer.match->place});
    }
  }

  /// As within a map, for later frames of all.
  [[nodiscard]] static bool likely(const Answer& answer) noexcept {
    return answer.match && answer.probability >= static_cast<float>(PlaceMap::likely);
  }

  void close(std::span<const Answer> answers) noexcept {
    answers_ = answers;
    for (const Answer& answer : answers) {
      if (answer.gate != Gate::match || !answer.match) continue;
      ++closed_;
      if (loops_.size() == loops_.capacity()) continue;
      const OthersMap::Place place = map_.where(answer.match->place);
      const Others::Names& names = talk_.names(place.session);
      OtherLoop& loop = loops_.emplace_back();
      loop.answer = answer;
      loop.answer.match->place = loop.answer.match->head = place.frame;
      loop.robot.assign({names.robot});
      loop.session.assign({names.session});
    }
  }

  std::shared_ptr<dds::Participant> participant_;
  OthersMap map_;
  ThroughOwn through_own_;
  SourceNumbers numbers_;
  bool novel_;
  std::span<const Answer> answers_;
  std::vector<OtherLoop> loops_;
  std::uint64_t closed_ = 0;
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

void Fleet::finish(std::span<const Answer> rest) noexcept { impl_->finish(rest); }

std::span<const OtherLoop> Fleet::loops() const noexcept { return impl_->loops(); }

std::size_t Fleet::places() const noexcept { return impl_->places(); }

void Fleet::add_to(nlohmann::ordered_json& frame) const { impl_->add_to(frame); }

std::optional<std::string> Fleet::trouble() { return impl_->trouble(); }

std::string Fleet::end() { return impl_->end(); }

}  // namespace seqloop::program
