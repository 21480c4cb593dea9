#pragma once
// Surfaces known exactly, to make scans of and to measure results against.

#include <string_view>
#include <variant>

#include "core/lattice.h"
#include "core/terrain.h"

namespace pss {

/// A ring about the z axis; the normal points out of the tube.
struct Torus {
  double major = 1;    ///< from the axis to the middle of the tube
  double minor = 0.4;  ///< of the tube; less than `major`
};

/// About the origin; the normal points outwards.
struct Sphere {
  double radius = 1;
};

/// The rectangle |x| <= width/2, |y| <= depth/2 on z = slope_x x + slope_y y; the normal points up.
struct Plane {
  double width = 100;
  double depth = 100;
  double slope_x = 0;
  double slope_y = 0;
};

/// The terrain's normal points up. Plane and terrain are unbounded where distances are measured.
using Surface = std::variant<Torus, Sphere, Plane, Terrain>;

struct SurfacePoint {
  World3 position{};
  World3 normal{};  ///< unit
};

/// The point of a surface nearest to a given one, and the surface there.
struct Foot {
  World3 position{};
  World3 normal{};            ///< unit
  double distance = 0;        ///< of the given point, positive on the normal's side
  double mean_curvature = 0;  ///< positive where the surface bends towards the normal
  double gaussian_curvature = 0;
};

const char* shape_name(const Surface& surface);  ///< "torus", "sphere", "plane", "terrain"
double area(const Surface& surface);
/// A box that holds every sample.
WorldBox bounds(const Surface& surface);
/// Whether the surface closes on itself when u goes from 0 to 1.
bool closed_in_u(const Surface& surface);

/// Maps [0, 1)^2 onto the surface, evenly by area.
SurfacePoint surface_point(const Surface& surface, double u, double v);

/// The point of the surface at a place close to it: the foot, and on a terrain the point straight
/// below or above, which is found sooner.
SurfacePoint settle(const Surface& surface, const World3& p);

/// Requires: `p` finite. Where several points are nearest (a sphere's centre), one of them.
Foot foot_of(const Surface& surface, const World3& p);

/// The x with x + e sin x = m.
///
/// Requires: |m| <= pi, 0 <= e < 1.
/// Source:   Kepler's equation, by Newton's method from below, where it is monotone.
double solve_kepler(double m, double e);

}  // namespace pss
