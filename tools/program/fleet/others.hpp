// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "seqloop/dds/fleet.hpp"

namespace seqloop::program {

/// Decides what is taken in of what others say, and says what is not. Anybody on the network may
/// say anything: memory is bounded, and one that does not keep to the rules is named once and not
/// heard any more. For one thread.
class Others {
 public:
  /// @param own what all places must be like
  /// @param in_map sessions that the map has already: they come back from who has heard them
  /// @param places that there is room for
  Others(dds::FleetSession own, std::vector<std::int64_t> in_map, std::size_t places);

  /// @param about nothing is said of the session: null
  /// @return of a place that is to be taken in, its session: counted from 0 as they are first heard
  [[nodiscard]] std::optional<std::uint32_t> hear(const dds::FleetPlace& place,
                                                  const dds::FleetSession* about);

  /// Names that a session came with, fit to be printed.
  struct Names {
    std::string robot;
    std::string session;
    std::int64_t began_ns = 0;
  };
  /// @param began_ns when the session began
  [[nodiscard]] static Names names_of(const dds::FleetSession& session, std::int64_t began_ns);

  /// What is known of a session from before this program began: as if it had been heard.
  struct Before {
    std::uint64_t places = 0;   ///< 1 or more
    std::uint64_t frame = 0;    ///< of the last
    std::int64_t first_ns = 0;  ///< of its drive
    std::int64_t newest_ns = 0;
  };
  /// @return its index, as `hear` gives them
  std::uint32_t resume(const Names& names, const Before& before);

  /// A place and one that it is a visit of, both taken in.
  struct SamePlace {
    std::uint32_t session;
    std::uint32_t visited;  ///< session
  };
  /// @param place that says it is a visit. @return nothing where one of the two was not taken in
  [[nodiscard]] std::optional<SamePlace> same_place(const dds::FleetPlace& place) const;

  /// Keeps a visit that `same_place` says nothing of yet: who tells it had heard the other place,
  /// which may still be on its way here. The newest 1,024 are kept, of sessions that may be heard.
  void wait_for_places(const dds::FleetPlace& visit);

  /// @return a visit that was kept and whose places have both come meanwhile, the oldest first; it
  ///   is not kept any more
  [[nodiscard]] std::optional<dds::FleetPlace> next_visit();

  /// @param place that says by what its session is standardised
  /// @return the session's index; nothing where no place of it was taken in, or it says nonsense:
  ///   then no more is taken in
  [[nodiscard]] std::optional<std::uint32_t> statistics(const dds::FleetPlace& place);

  [[nodiscard]] const Names& names(std::uint32_t session) const { return names_[session]; }

  /// What a person should know, one line each, once.
  [[nodiscard]] std::vector<std::string> news();

  [[nodiscard]] std::size_t sessions() const noexcept { return names_.size(); }
  [[nodiscard]] std::uint64_t places() const noexcept { return taken_; }

 private:
  struct Session {
    Names names;
    std::optional<std::uint32_t> index;  // once something was taken in
    bool refused = false;
    std::uint64_t places = 0;
    std::uint64_t frame = 0;    // of the last place
    std::int64_t first_ns = 0;  // of its drive
    std::int64_t newest_ns = 0;
  };

  [[nodiscard]] bool may_be_heard(std::int64_t session) const;
  [[nodiscard]] Session* known(const dds::FleetPlace& place, const dds::FleetSession* about);
  [[nodiscard]] std::optional<std::string> fault(const Session& session,
                                                 const dds::FleetPlace& place) const;
  void tell(std::string text);

  dds::FleetSession own_;
  std::vector<std::int64_t> in_map_;
  std::size_t room_;
  std::map<std::int64_t, Session> sessions_;
  std::vector<Names> names_;  // never moves: room for all is there
  std::uint64_t taken_ = 0;
  std::deque<dds::FleetPlace> early_;  // visits
  std::size_t looked_at_ = 0;          // of these
  std::uint64_t taken_then_ = 0;       // when that began
  bool full_ = false;
  bool crowded_ = false;
  std::vector<std::string> news_;
};

}  // namespace seqloop::program
