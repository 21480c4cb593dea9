#include "io/synth/synth_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace pss {
namespace {

using Json = nlohmann::ordered_json;

Error usage(std::string message) { return {Fault::kUsage, std::move(message)}; }

bool within(double value, double low, double high) { return value >= low && value <= high; }

Json sizes_of(const Torus& torus) {
  return {{"major_radius", torus.major}, {"minor_radius", torus.minor}};
}
Json sizes_of(const Sphere& sphere) { return {{"radius", sphere.radius}}; }
Json sizes_of(const Plane& plane) {
  return {{"width", plane.width},
          {"depth", plane.depth},
          {"slope_x", plane.slope_x},
          {"slope_y", plane.slope_y}};
}
Json sizes_of(const Terrain& terrain) {
  return {{"width", terrain.width()}, {"depth", terrain.depth()}};
}

/// The sizes of a shape; those past `lengths` may have any sign.
struct ShapeSizes {
  std::string_view shape;
  std::size_t count, lengths;
  std::array<double, 4> defaults;
};

constexpr std::array kShapes{
    ShapeSizes{"torus", 2, 2, {1, 0.4}},
    ShapeSizes{"sphere", 1, 1, {1}},
    ShapeSizes{"plane", 4, 2, {100, 100, 0, 0}},
    ShapeSizes{"terrain", 2, 2, {1000, 1000}},
};

Result<std::array<double, 4>> complete(const ShapeSizes& shape, const std::vector<double>& given) {
  if (given.size() > shape.count)
    return usage(fmt::format("{} sizes for a {}, expected at most {}", given.size(), shape.shape,
                             shape.count));
  std::array<double, 4> sizes = shape.defaults;
  std::ranges::copy(given, sizes.begin());
  for (std::size_t i = 0; i < shape.count; ++i) {
    const bool is_length = i < shape.lengths;
    if (is_length ? within(sizes[i], 1e-9, 1e9) : within(sizes[i], -10, 10)) continue;
    return usage(fmt::format("size {} for a {}, expected {}", sizes[i], shape.shape,
                             is_length ? "1e-9 to 1e9" : "a slope from -10 to 10"));
  }
  return sizes;
}

}  // namespace

double spacing(const SynthOptions& options) {
  const std::uint64_t points = std::max<std::uint64_t>(options.points, 1);
  return std::sqrt(area(options.surface) / static_cast<double>(points));
}

double default_scale(double spacing) {
  // Powers of ten up to 10^22 are exact, so their inverses are the nearest doubles.
  const double limit = spacing / 1000;
  double power = 1;
  if (limit >= 1) {
    while (power * 10 <= limit && power < 1e22) power *= 10;
    return power;
  }
  while (1 / power > limit && power < 1e22) power *= 10;
  return 1 / power;
}

Lattice grid(const SynthOptions& options) {
  const double step = options.scale.value_or(default_scale(spacing(options)));
  return {{step, step, step}, options.offset};
}

Result<void> check(const SynthOptions& options) {
  if (options.points > std::uint64_t{1} << 40)
    return usage(fmt::format("{} points, expected at most 2^40", options.points));
  if (!within(options.scans, 1, 65535))
    return usage(fmt::format("{} scans, expected 1 to 65535", options.scans));
  if (!within(options.noise, 0, 1e6))
    return usage(fmt::format("noise of {} spacings, expected 0 or more", options.noise));
  if (!within(options.jitter, 0, 10))
    return usage(fmt::format("jitter of {} spacings, expected 0 to 10", options.jitter));
  if (!within(options.corner_density, 1, 1e6))
    return usage(fmt::format("corner density {}, expected 1 to 1e6", options.corner_density));
  if (!within(options.density_gradient, 1, 1e6))
    return usage(fmt::format("density gradient {}, expected 1 to 1e6", options.density_gradient));
  if (options.scale && !within(*options.scale, 1e-15, 1e9))
    return usage(fmt::format("scale {}, expected 1e-15 to 1e9", *options.scale));
  for (const double coordinate : options.offset)
    if (!within(coordinate, -1e12, 1e12))
      return usage(fmt::format("offset {}, expected -1e12 to 1e12", coordinate));
  const double margin = 10 * (options.noise + options.jitter) * spacing(options);
  const double side = bounds(options.surface).max[0] + margin;
  if (!(side / grid(options).scale[0] < static_cast<double>(kLatticeMax)))
    return usage(
        fmt::format("a scale of {} needs more than {} bits for a surface of {}, use a "
                    "larger one",
                    grid(options).scale[0], kLatticeBits, 2 * side));
  return {};
}

Result<Surface> make_surface(std::string_view name, const std::vector<double>& sizes) {
  const auto* const known = std::ranges::find(kShapes, name, &ShapeSizes::shape);
  if (known == kShapes.end())
    return usage(fmt::format("shape '{}', expected torus, sphere, plane or terrain", name));
  PSS_ASSIGN(const auto s, complete(*known, sizes));
  if (name == "sphere") return Surface(Sphere{s[0]});
  if (name == "plane") return Surface(Plane{s[0], s[1], s[2], s[3]});
  if (name == "terrain") return Surface(Terrain(s[0], s[1]));
  if (!(s[1] < s[0]))
    return usage(
        fmt::format("a torus of radii {} and {}, expected the first to be larger", s[0], s[1]));
  return Surface(Torus{s[0], s[1]});
}

std::string parameters_json(const SynthOptions& options) {
  const double s = spacing(options);
  Json json{{"shape", shape_name(options.surface)}};
  json.update(std::visit([](const auto& shape) { return sizes_of(shape); }, options.surface));
  json.update(Json{{"area", area(options.surface)},
                   {"offset", options.offset},
                   {"points", options.points},
                   {"scans", options.scans},
                   {"spacing", s},
                   {"noise", options.noise},
                   {"sigma", options.noise * s},
                   {"jitter", options.jitter},
                   {"corner_density", options.corner_density},
                   {"density_gradient", options.density_gradient},
                   {"scale", grid(options).scale[0]},
                   {"seed", options.seed}});
  return json.dump(2);
}

}  // namespace pss
