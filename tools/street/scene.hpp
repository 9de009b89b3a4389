// SPDX-License-Identifier: MIT
// Everything one frame shows, as flat surfaces and sprites in camera coordinates.
#pragma once

#include <initializer_list>
#include <vector>

#include "camera.hpp"
#include "layout.hpp"
#include "light.hpp"
#include "world.hpp"

namespace seqloop::street {

/// Where the camera is and what the day is like, for one frame.
struct Shot {
  double position = 0.0;  ///< path metre
  std::size_t leg = 0;
  double lateral = -1.9;                      ///< metres left of the centre line
  double height = 1.6;                        ///< metres above the road
  double yaw = 0.0, pitch = 0.0, roll = 0.0;  ///< rad: left, up, clockwise
  double time = 0.0;                          ///< frames since the start; moves cars and clouds
  std::uint64_t traffic = 0;  ///< seed of what does not stay: cars, people, lit windows, clouds
  std::uint64_t noise = 0;    ///< seed of this frame's sensor noise
  Light light;
};

/// A stretch of ground between two cross-sections of the road.
struct Strip {
  float street{};        ///< metres from its cell's begin to its first cross-section
  float length{};        ///< metres on the centre line
  float bend{};          ///< tangent of half its turn to the left
  std::int32_t cell{};   ///< the cell that holds it
  std::uint32_t seed{};  ///< of what is worn and patched, the street's
  bool crossing{};
  Color paving, verge;
};

struct CarPaint {
  Color body;
  std::uint32_t seed{};
  float length{}, height{};  ///< metres
  bool van{};
};

struct Sprite {
  Thing thing{};
  std::uint32_t seed{};
  Vec3 foot;                ///< camera coordinates
  float width{}, height{};  ///< metres
  float sun{};              ///< share of sunlight on it, 0..1
};

/// A darkening of the ground: the sun's (`contact` false) or of a car above it.
struct Shadow {
  Surface area;
  bool contact{}, round{};
  float strength{};  ///< 0..1
};

struct Corner {
  double u, v;
};

/// Lists of what is in view; kept from frame to frame so that their memory is used again.
struct Scene {
  Camera camera;
  const Light* light{};
  std::uint64_t traffic{};
  Vec3 to_sun;  ///< unit, layout frame
  std::vector<Surface> surfaces;
  std::vector<Facade> facades;
  std::vector<Strip> strips;
  std::vector<CarPaint> cars;
  std::vector<Sprite> sprites;
  std::vector<Shadow> shadows;

  void clear();
  /// Adds a polygon at origin + u * along_u + v * along_v, both of unit length and upright to one
  /// another. Nothing is added when it lies wholly behind the camera.
  Surface* add(Material material, std::size_t item, Vec3 origin, Vec3 along_u, Vec3 along_v,
               std::initializer_list<Corner> corners);
  /// Shadow of an upright wall from a to b (both on the ground) that is `height` metres high.
  void add_wall_shadow(Vec3 a, Vec3 b, double height);
  void add_round_shadow(Vec3 at, double width, double height);
};

/// Makes a polygon; see Scene::add.
Surface make_surface(const Camera& camera, Vec3 origin, Vec3 along_u, Vec3 along_v,
                     std::initializer_list<Corner> corners);

void add_ground(const World& world, const Layout& layout, Scene& scene);
void add_building(const Building& building, const Piece& piece, const Layout& layout, Scene& scene);
void add_fence(const Fence& fence, const Piece& piece, const Layout& layout, Scene& scene);
void add_prop(const Prop& prop, const Piece& piece, const Layout& layout, Scene& scene);
/// Cars that stand at the kerb of one cell.
void add_parked_cars(std::int64_t cell, const World& world, const Piece& piece,
                     const Layout& layout, Scene& scene);
/// People on the pavements of one cell; others in another drive.
void add_people(std::int64_t cell, const Piece& piece, const Layout& layout, Scene& scene);
/// Cars that come towards the camera.
void add_oncoming_cars(const Shot& shot, const Layout& layout, Scene& scene);

/// Fills the scene with all that stands around a shot.
void build_scene(const World& world, const Path& path, const Shot& shot, int width, int height,
                 Scene& scene);

}  // namespace seqloop::street
