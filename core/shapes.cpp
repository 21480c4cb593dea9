#include "core/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sin_cos.h"

namespace pss {
namespace {

constexpr double kPi = std::numbers::pi;

template <class... Fs>
struct Overload : Fs... {
  using Fs::operator()...;
};
template <class... Fs>
Overload(Fs...) -> Overload<Fs...>;

double length(double x, double y, double z = 0) { return std::sqrt(x * x + y * y + z * z); }

/// The angle of a fraction of a turn, within [-pi, pi).
double angle_of(double fraction) { return 2 * kPi * (fraction < 0.5 ? fraction : fraction - 1); }

SurfacePoint sample(const Torus& torus, double u, double v) {
  const double around = angle_of(u);
  const double tube = solve_kepler(angle_of(v), torus.minor / torus.major);
  const auto [z, c] = sin_cos(tube);
  const auto [y, x] = sin_cos(around);
  const double ring = torus.major + torus.minor * c;
  return {{ring * x, ring * y, torus.minor * z}, {c * x, c * y, z}};
}

SurfacePoint sample(const Sphere& sphere, double u, double v) {
  const double around = angle_of(u);
  const double z = 1 - 2 * v;
  const double ring = 2 * std::sqrt(v * (1 - v));
  const auto [y, x] = sin_cos(around);
  const World3 n{ring * x, ring * y, z};
  return {{sphere.radius * n[0], sphere.radius * n[1], sphere.radius * n[2]}, n};
}

/// The upward normal of z = f(x, y) from f's slopes.
World3 upward(double slope_x, double slope_y) {
  const double z = 1 / std::sqrt(1 + slope_x * slope_x + slope_y * slope_y);
  return {-slope_x * z, -slope_y * z, z};
}

SurfacePoint sample(const Plane& plane, double u, double v) {
  const double x = (u - 0.5) * plane.width;
  const double y = (v - 0.5) * plane.depth;
  return {{x, y, plane.slope_x * x + plane.slope_y * y}, upward(plane.slope_x, plane.slope_y)};
}

SurfacePoint point_at(const Terrain& terrain, double x, double y) {
  const Height h = terrain.height(x, y);
  return {{x, y, h.z}, upward(h.x, h.y)};
}

SurfacePoint sample(const Terrain& terrain, double u, double v) {
  const auto [x, y] = terrain.place(u, v);
  return point_at(terrain, x, y);
}

Foot foot(const Torus& torus, const World3& p) {
  const double rho = length(p[0], p[1]);
  const World3 out = rho > 0 ? World3{p[0] / rho, p[1] / rho, 0} : World3{1, 0, 0};
  const double across = rho - torus.major;
  const double from_middle = length(across, p[2]);
  const double c = from_middle > 0 ? across / from_middle : 1;
  const double s = from_middle > 0 ? p[2] / from_middle : 0;
  const double ring = torus.major + torus.minor * c;
  Foot foot;
  foot.position = {ring * out[0], ring * out[1], torus.minor * s};
  foot.normal = {c * out[0], c * out[1], s};
  foot.distance = from_middle - torus.minor;
  foot.mean_curvature = -(torus.major + 2 * torus.minor * c) / (2 * torus.minor * ring);
  foot.gaussian_curvature = c / (torus.minor * ring);
  return foot;
}

Foot foot(const Sphere& sphere, const World3& p) {
  const double r = sphere.radius;
  const double from_centre = length(p[0], p[1], p[2]);
  const World3 n = from_centre > 0
                       ? World3{p[0] / from_centre, p[1] / from_centre, p[2] / from_centre}
                       : World3{0, 0, 1};
  return {{r * n[0], r * n[1], r * n[2]}, n, from_centre - r, -1 / r, 1 / (r * r)};
}

Foot foot(const Plane& plane, const World3& p) {
  const World3 n = upward(plane.slope_x, plane.slope_y);
  const double distance = p[0] * n[0] + p[1] * n[1] + p[2] * n[2];
  return {
      {p[0] - distance * n[0], p[1] - distance * n[1], p[2] - distance * n[2]}, n, distance, 0, 0};
}

Foot foot(const Terrain& terrain, const World3& p) {
  const auto [x, y] = terrain.nearest(p);
  const Height h = terrain.height(x, y);
  const World3 n = upward(h.x, h.y);
  const double z = 1 + h.x * h.x + h.y * h.y;
  Foot foot;
  foot.position = {x, y, h.z};
  foot.normal = n;
  foot.distance = (p[0] - x) * n[0] + (p[1] - y) * n[1] + (p[2] - h.z) * n[2];
  foot.mean_curvature = ((1 + h.y * h.y) * h.xx - 2 * h.x * h.y * h.xy + (1 + h.x * h.x) * h.yy) /
                        (2 * z * std::sqrt(z));
  foot.gaussian_curvature = (h.xx * h.yy - h.xy * h.xy) / (z * z);
  return foot;
}

WorldBox about_origin(double x, double y, double z) { return {{-x, -y, -z}, {x, y, z}}; }

}  // namespace

double solve_kepler(double m, double e) {
  constexpr int kMaxSteps = 60;
  // The left side is concave on [0, pi]: from below the root, Newton's steps never pass it.
  const double target = std::abs(m);
  double x = target / (1 + e);
  for (int step = 0; step < kMaxSteps; ++step) {
    const auto [s, c] = sin_cos(x);
    const double change = (target - x - e * s) / (1 + e * c);
    x += change;
    if (!(std::abs(change) > 1e-8)) break;  // squared by the step just taken
  }
  return m < 0 ? -x : x;
}

const char* shape_name(const Surface& surface) {
  return std::visit(
      Overload{[](const Torus&) { return "torus"; }, [](const Sphere&) { return "sphere"; },
               [](const Plane&) { return "plane"; }, [](const Terrain&) { return "terrain"; }},
      surface);
}

double area(const Surface& surface) {
  return std::visit(Overload{[](const Torus& s) { return 4 * kPi * kPi * s.major * s.minor; },
                             [](const Sphere& s) { return 4 * kPi * s.radius * s.radius; },
                             [](const Plane& s) {
                               return s.width * s.depth *
                                      std::sqrt(1 + s.slope_x * s.slope_x + s.slope_y * s.slope_y);
                             },
                             [](const Terrain& s) { return s.area(); }},
                    surface);
}

WorldBox bounds(const Surface& surface) {
  return std::visit(
      Overload{[](const Torus& s) {
                 return about_origin(s.major + s.minor, s.major + s.minor, s.minor);
               },
               [](const Sphere& s) { return about_origin(s.radius, s.radius, s.radius); },
               [](const Plane& s) {
                 return about_origin(
                     s.width / 2, s.depth / 2,
                     (std::abs(s.slope_x) * s.width + std::abs(s.slope_y) * s.depth) / 2);
               },
               [](const Terrain& s) {
                 return about_origin(s.width() / 2, s.depth() / 2, s.amplitude());
               }},
      surface);
}

bool closed_in_u(const Surface& surface) { return surface.index() < 2; }

SurfacePoint surface_point(const Surface& surface, double u, double v) {
  return std::visit([&](const auto& shape) { return sample(shape, u, v); }, surface);
}

SurfacePoint settle(const Surface& surface, const World3& p) {
  if (const Terrain* terrain = std::get_if<Terrain>(&surface))
    return point_at(*terrain, p[0], p[1]);
  const Foot foot = foot_of(surface, p);
  return {foot.position, foot.normal};
}

Foot foot_of(const Surface& surface, const World3& p) {
  return std::visit([&](const auto& shape) { return foot(shape, p); }, surface);
}

}  // namespace pss
