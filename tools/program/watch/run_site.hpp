// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>

#include "program/map/lasting_map.hpp"
#include "program/map/place_pictures.hpp"
#include "program/watch/picture_store.hpp"
#include "program/watch/run_view.hpp"
#include "seqloop/http/server.hpp"

namespace seqloop::program {

/// What a server shows of a run that goes on, and takes for it. One lock guards all of it; the loop
/// never takes that lock.
class RunSite : public http::Site {
 public:
  static constexpr std::size_t pictures_a_second = 10;
  static constexpr std::size_t most_loops_at_once = 100;

  /// @param watch lives longer
  /// @param pictures of a map's places; null: there are those that `add_place` brings
  RunSite(Watch& watch, nlohmann::ordered_json run, bool own_places,
          std::unique_ptr<PlacePictures> pictures = nullptr)
      : watch_(&watch),
        own_places_(own_places),
        saved_places_(std::move(pictures)),
        view_(std::move(run)) {}

  /// @param server for its counts; lives as long as anybody asks
  void serve_by(const http::Server& server) { server_ = &server; }

  void add_place(const Image& image, std::uint64_t number);

  /// The map that the drive is added to. @param map lives longer
  void keep_in(LastingMap& map);

  /// Takes what the loop has handed over since, and makes an event of it where somebody looks.
  void follow();
  /// The same for the last time; those who look are told that it was.
  void end();

  [[nodiscard]] http::Reply get(std::string_view path, std::string_view query) override;
  [[nodiscard]] http::Reply post(std::string_view path, std::string_view body) override;
  [[nodiscard]] std::shared_ptr<const std::string> event(std::uint64_t& last) override;

 private:
  using Clock = std::chrono::steady_clock;
  using Json = nlohmann::ordered_json;

  /// What all who look are to see pictures of: the same for all, and not changed so often that
  /// pictures would be out of date before they have come.
  struct Shown {
    Json frame;
    Json place;
    Json runner_up;  ///< where two places look alike
    std::size_t loops = 0;
    Clock::time_point pair_at{};
    Clock::time_point loops_at{};
  };

  void take();
  void tell();
  void choose_shown();
  [[nodiscard]] bool looked_at() const;
  [[nodiscard]] std::string trouble() const;
  [[nodiscard]] Json status() const;
  [[nodiscard]] http::Reply metrics() const;
  [[nodiscard]] http::Reply around(std::string_view query) const;
  [[nodiscard]] http::Reply picture(std::string_view query);
  [[nodiscard]] http::Reply control(const Json& wish);
  [[nodiscard]] http::Reply set_threshold(const Json& wish);
  [[nodiscard]] http::Reply judge(const Json& wish);

  Watch* watch_;
  LastingMap* map_ = nullptr;
  /// When it was made, in ns: a page that comes back sees whether this is still its run. JSON's
  /// numbers are too short for it in a browser.
  std::string id_ = std::to_string(std::chrono::system_clock::now().time_since_epoch().count());
  bool own_places_;
  std::unique_ptr<PlacePictures> saved_places_;  // not guarded: it takes care of itself
  const http::Server* server_ = nullptr;
  mutable std::mutex mutex_;
  std::condition_variable told_;
  RunView view_;
  PictureStore frames_;
  PictureStore places_;
  std::map<std::pair<bool, std::uint64_t>, std::string> encoded_;
  std::deque<Clock::time_point> encoded_at_;
  bool ended_ = false;
  Shown shown_;

  std::shared_ptr<const std::string> event_;
  std::uint64_t event_number_ = 1;
  std::uint64_t told_frames_ = 0;
  std::uint64_t told_answers_ = 0;
  Clock::time_point told_at_{};
  Clock::time_point looked_at_{};
};

}  // namespace seqloop::program
