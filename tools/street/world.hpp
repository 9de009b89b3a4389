// SPDX-License-Identifier: MIT
// What stands beside the street: houses, trees, lamps and fences, found from hashes alone.
#pragma once

#include <cstdint>
#include <vector>

#include "math.hpp"

namespace seqloop::street {

constexpr double kCell = 48.0;       ///< metres of street described together
constexpr double kCrossing = 11.0;   ///< metres of a cell that a side street takes
constexpr double kRoadHalf = 5.2;    ///< metres from the centre line to the kerb
constexpr double kFacadeLine = 8.6;  ///< metres from the centre line to the nearest houses

enum class Cladding : std::uint8_t { plaster, brick, panels, boards, stone };
enum class GroundFloor : std::uint8_t { windows, shop, garage };
enum class Roof : std::uint8_t { flat, gable };

/// Looks of one front; lengths in metres.
struct Facade {
  std::uint32_t seed{};
  Cladding cladding{};
  GroundFloor ground{};
  Color wall, trim, accent;
  float width{}, height{};
  float ground_height{}, floor_height{};
  float bay{}, margin{};  ///< width of a window's column; wall left before the first
  float window_width{}, window_height{};
  float door{};               ///< where the door begins, from the left end
  std::uint32_t balconies{};  ///< one bit a column
  bool shutters{}, arched{}, bands{}, front{};
};

struct Building {
  int side{};             ///< +1 left, -1 right
  double begin{}, end{};  ///< street metres
  double setback{}, depth{}, height{};
  double ridge{};  ///< metres from eaves to ridge, 0 for a flat roof
  bool chimney{}, hanging_sign{}, awning{};
  Color roof;
  Facade front, flank;
};

enum class Thing : std::uint8_t { broadleaf, conifer, bush, lamp, pole_sign, person };

/// Something thin or round that looks the same from all sides.
struct Prop {
  Thing thing{};
  std::uint32_t seed{};
  double s{}, d{};  ///< metres along the street and left of its centre
  double width{}, height{};
};

/// Hedge, fence or garden wall along the street.
struct Fence {
  double begin{}, end{}, d{}, height{};
  Color color;
  bool hedge{};
};

/// Fixed contents of street metres [k * kCell, (k + 1) * kCell).
struct Cell {
  bool crossing = false;  ///< a side street takes its first kCrossing metres
  Color paving, verge;
  std::vector<Building> buildings;
  std::vector<Prop> props;
  std::vector<Fence> fences;
};

/// The same cell each time it is asked for; nothing is stored.
class World {
 public:
  explicit World(std::uint64_t seed) noexcept : seed_(seed) {}

  std::uint64_t seed() const noexcept { return seed_; }
  /// @return true where cell k begins with a side street.
  bool crossing(std::int64_t k) const noexcept;
  /// Work: some hundred hashes. Allocates: the cell's lists.
  Cell cell(std::int64_t k) const;

 private:
  std::uint64_t seed_;
};

/// Looks of a front. @param dice decides. @param style 0..4: old town, plaster, modern, suburb,
/// works. @param width metres, above 3. @param height metres, above 2.5.
Facade make_facade(Dice& dice, int style, double width, double height);

}  // namespace seqloop::street
