// SPDX-License-Identifier: MIT
#include "program/watch/ros_answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "program/run/closure.hpp"
#include "program/run/frame_times.hpp"
#include "program/watch/background.hpp"
#include "program/watch/pair_picture.hpp"
#include "program/watch/picture_store.hpp"
#include "program/watch/take.hpp"
#include "ros/wall_time.hpp"
#include "seqloop/dds/publisher.hpp"

namespace seqloop::program {
namespace {

using namespace std::chrono_literals;
using SteadyTime = std::chrono::steady_clock::time_point;

constexpr auto round_time = 10ms;
constexpr auto status_interval = 1s;
constexpr auto pair_interval = 500ms;
constexpr auto patience_at_end = 1s;

std::string number(double value) { return fmt::format("{:.3g}", value); }

}  // namespace

class RosAnswers::Impl {
 public:
  Impl(std::shared_ptr<dds::Participant> participant, StampAt stamp_ns, bool own_places,
       std::unique_ptr<PlacePictures> pictures)
      : participant_(std::move(participant)),
        publisher_(*participant_),
        stamp_ns_(std::move(stamp_ns)),
        own_places_(own_places),
        saved_places_(std::move(pictures)),
        thread_([this] { follow(); }) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  Impl(Impl&&) = delete;
  Impl& operator=(Impl&&) = delete;
  ~Impl() { end(); }

  void end() {
    if (!thread_.joinable()) return;
    ending_ = true;
    thread_.join();
  }

  /// The loop's side.
  void publish(const ProcessedFrame& processed, const LoopState& state, const RunSummary& summary,
               const MapState& map, Nanoseconds moment) noexcept {
    watch.publish(processed, state, summary, map, moment);
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_ + watch.unseen(); }

  Watch watch;
  // The loop fills these before the first frame.
  PictureStore known;  // places of another drive
  std::vector<LastingMap::Session> sessions;

 private:
  void follow() {
    become_background();
    while (!ending_) {
      look();
      std::this_thread::sleep_for(round_time);
    }
    take_all(true);
    send_status();
    publisher_.flush(patience_at_end);
  }

  void look() {
    take_all(false);
    const SteadyTime now = std::chrono::steady_clock::now();
    if (now - status_sent_ >= status_interval) send_status();
  }

  /// @param all also answers about a frame that has not come here
  void take_all(bool all) {
    take(
        watch, frames_,
        [this](const Snapshot& snapshot) {
          newest_ = snapshot;
          if (snapshot.frame.report.gate == Gate::no_frame) return;
          times_.add(
              {snapshot.frame.report.newest, snapshot.frame.frame.time_s, snapshot.map.newest});
        },
        [this, all](const Answer& answer) {
          if (!all && !has_come(answer)) return false;
          if (closes_loop(answer)) send(answer);
          return true;
        },
        [this, all](const OtherLoop& loop) {
          if (!all && !has_come(loop.answer)) return false;
          ++matches_;
          count(publisher_.publish(closure_of(loop, times_, stamp_ns_)));
          return true;
        });
  }

  /// Whether the frame that an answer is about has come here.
  [[nodiscard]] bool has_come(const Answer& answer) const {
    return times_.at(answer.frame) || answer.frame <= newest_frame();
  }

  void send(const Answer& answer) {
    const ros::LoopClosure closure =
        closure_of(answer, times_, stamp_ns_, session_of(answer.match->place));
    ++matches_;
    count(publisher_.publish(closure));
    const SteadyTime now = std::chrono::steady_clock::now();
    if (now - pair_sent_ < pair_interval || !publisher_.pair_is_wanted()) return;
    pair_sent_ = now;
    const std::vector<std::uint8_t> pair =
        pair_picture(nearest_jpeg(frames_, closure.frame), place_jpeg(closure.match));
    if (!pair.empty()) count(publisher_.publish_pair(closure.stamp_ns, pair));
  }

  [[nodiscard]] std::string place_jpeg(std::uint64_t place) const {
    if (!saved_places_) return nearest_jpeg(own_places_ ? frames_ : known, place);
    try {
      return nearest_jpeg(*saved_places_, place);
    } catch (const SetupError&) {
      return {};  // the map's file cannot be read just now: there is no pair of this one
    }
  }

  /// Numbers of places grow from session to session.
  [[nodiscard]] std::string_view session_of(std::uint64_t place) const {
    const auto next = std::ranges::upper_bound(sessions, place, {}, &LastingMap::Session::first);
    return next == sessions.begin() ? std::string_view() : std::prev(next)->name;
  }

  void send_status() {
    const SteadyTime now = std::chrono::steady_clock::now();
    const double since_s = std::chrono::duration<double>(now - status_sent_).count();
    status_sent_ = now;
    if (!newest_) return;
    const RunCounts& counts = newest_->counts;
    const FrameReport& report = newest_->frame.report;
    const auto at = [&](Gate gate) { return counts.at[static_cast<std::size_t>(gate)]; };
    ros::Status status;
    status.stamp_ns = times_.all().empty() ? 0 : stamp_ns_(times_.newest_s());
    status.state = name(report.gate);
    status.frames = counts.frames;
    status.matches = matches_;
    status.places = newest_->map.places;
    if (report.now) {
      status.place = report.now->frame();
      status.probability = static_cast<double>(report.now->probability);
    }
    status.errors = at(Gate::frame_error);
    status.dropped = counts.dropped;
    status.lost = counts.lost;
    status.misses = counts.misses;
    status.unpublished = dropped();
    count(publisher_.publish(status));
    diagnose(status, static_cast<double>(counts.frames - frames_told_) / since_s);
    frames_told_ = counts.frames;
  }

  void diagnose(const ros::Status& status, double rate) {
    using Level = ros::Diagnosis::Level;
    const bool silent = newest_->frame.report.gate == Gate::no_frame;
    const bool unreadable = !silent && !newest_->fault.empty();
    const std::vector<ros::Diagnosis> diagnoses{
        {silent       ? Level::error
         : unreadable ? Level::warning
                      : Level::ok,
         "seqloop: camera",
         newest_->fault.empty() ? "frames come" : std::string(newest_->fault.view()),
         {{"frames", std::to_string(status.frames)},
          {"frames a second", number(rate)},
          {"unreadable", std::to_string(status.errors)},
          {"dropped", std::to_string(status.dropped)},
          {"lost", std::to_string(status.lost)}}},
        {newest_->state.overloaded ? Level::warning : Level::ok,
         "seqloop: loop",
         newest_->state.overloaded ? "too slow: frames are left out" : status.state,
         {{"matches", std::to_string(status.matches)},
          {"missed the budget", std::to_string(status.misses)},
          {"probability now", number(status.probability)},
          {"unpublished", std::to_string(status.unpublished)}}},
        {newest_->frame.report.map_full ? Level::warning : Level::ok,
         "seqloop: map",
         newest_->frame.report.map_full ? "the map is full" : "there is room",
         {{"places", std::to_string(status.places)}}}};
    count(publisher_.publish(ros::wall_ns(), diagnoses));
  }

  void count(bool sent) noexcept {
    if (!sent) ++dropped_;
  }

  [[nodiscard]] std::uint64_t newest_frame() const noexcept {
    return newest_ ? newest_->frame.report.newest : 0;
  }

  std::shared_ptr<dds::Participant> participant_;
  dds::Publisher publisher_;
  StampAt stamp_ns_;
  bool own_places_;
  std::unique_ptr<PlacePictures> saved_places_;
  std::atomic<std::uint64_t> dropped_{0};

  // The thread's.
  FrameTimes times_;
  PictureStore frames_;
  std::optional<Snapshot> newest_;
  std::uint64_t matches_ = 0;
  std::uint64_t frames_told_ = 0;
  SteadyTime status_sent_ = std::chrono::steady_clock::now();
  SteadyTime pair_sent_;

  std::atomic<bool> ending_{false};
  std::thread thread_;
};

RosAnswers::RosAnswers(std::shared_ptr<dds::Participant> participant, StampAt stamp_ns,
                       bool own_places, std::unique_ptr<PlacePictures> pictures)
    : impl_(std::make_unique<Impl>(std::move(participant), std::move(stamp_ns), own_places,
                                   std::move(pictures))) {}

RosAnswers::~RosAnswers() = default;

void RosAnswers::add_place(const Image& image, std::uint64_t number) {
  SmallPicture small;
  if (shrink(image, number, small)) impl_->known.add(small);
}

void RosAnswers::keep_in(const LastingMap& map) { impl_->sessions = map.sessions(); }

void RosAnswers::publish(const ProcessedFrame& processed, const LoopState& state,
                         const RunSummary& summary, const MapState& map,
                         Nanoseconds moment) noexcept {
  impl_->publish(processed, state, summary, map, moment);
}

void RosAnswers::publish(std::span<const Answer> answers) noexcept {
  impl_->watch.publish(answers);
}

void RosAnswers::publish(std::span<const OtherLoop> loops) noexcept { impl_->watch.publish(loops); }

std::uint64_t RosAnswers::end() {
  impl_->end();
  return impl_->dropped();
}

}  // namespace seqloop::program
