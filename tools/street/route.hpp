// SPDX-License-Identifier: MIT
// Where the streets go: one endless street, and a path of legs over parts of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace seqloop::street {

/// An endless street; every metre of it has one heading, found in constant time.
class Street {
 public:
  explicit Street(std::uint64_t seed) noexcept : seed_(seed) {}

  std::uint64_t seed() const noexcept { return seed_; }
  /// @param s metres along the street, at least -1000. @return heading in rad, smooth in s.
  double heading(double s) const noexcept;

 private:
  double section_heading(std::int64_t k) const noexcept;

  std::uint64_t seed_;
};

/// One stretch of the street, driven once in the direction of growing s.
struct Leg {
  double start = 0.0;   ///< street position of its first metre
  double length = 0.0;  ///< metres
  bool fresh = true;    ///< never driven before
  bool joined = false;  ///< the leg before leads into this one; else the camera is put here
};

/// A part of the surroundings: path metres [begin, end) show street metres from begin + offset.
struct Piece {
  double begin, end;
  double offset;
  std::size_t leg;
};

/// The legs of a drive, end to end. Where two legs meet the road bends from one heading to the
/// other, on the fresh one of the two, so that a second visit looks like the first.
class Path {
 public:
  static constexpr double kBend = 36.0;  ///< metres of a fresh leg that bend to meet another

  /// @param legs at least one, each of them longer than 0.
  Path(Street street, std::vector<Leg> legs);

  const Street& street() const noexcept { return street_; }
  const std::vector<Leg>& legs() const noexcept { return legs_; }
  double length() const noexcept { return begins_.back(); }
  /// Path metre at which a leg begins. @param leg 0..legs().size(), the last gives length().
  double begin(std::size_t leg) const noexcept { return begins_[leg]; }
  /// @param p path metre, 0..length(). @return the leg that holds it.
  std::size_t leg_at(double p) const noexcept;
  /// @return street metre of path metre p, which lies on `leg` or on its extension.
  double street_at(std::size_t leg, double p) const noexcept {
    return legs_[leg].start + (p - begins_[leg]);
  }
  /// Absolute heading in rad; continuous over joined legs but for whole turns.
  double heading(std::size_t leg, double p) const noexcept;
  /// What a camera on `leg` has around it, from p - behind to p + ahead, in order.
  std::vector<Piece> around(std::size_t leg, double p, double behind, double ahead) const;
  /// True where the road bends so hard from one leg into another that no house fits beside it.
  bool in_bend(std::size_t leg, double p) const noexcept;

 private:
  Street street_;
  std::vector<Leg> legs_;
  std::vector<double> begins_;
  std::vector<double> turn_in_, turn_out_;  ///< rad that a leg bends at its ends
};

/// @return the same angle in (-pi, pi].
double wrap_angle(double angle) noexcept;

}  // namespace seqloop::street
