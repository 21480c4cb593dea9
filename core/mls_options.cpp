#include "core/mls_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/support.h"

namespace pss {
namespace {

constexpr int kMostNearest = 10000;
constexpr double kWidthsPerSpacing = 2;  ///< h over the spacing, without noise
constexpr double kCapSpacings = 10;      ///< default cap of the distance to a k-th neighbour

Error usage(std::string message) { return {Fault::kUsage, std::move(message)}; }

Result<void> check_widths(const MlsOptions& options) {
  for (const auto& [name, value] : {std::pair{"h", options.h}, {"radius", options.radius}})
    if (!(value >= 0 && std::isfinite(value)))
      return usage(fmt::format("{}: found {}, expected a length, or 0 to choose one", name, value));
  if (options.radius > 0 && options.radius < options.h)
    return usage(
        fmt::format("radius: found {}, expected at least h, {}", options.radius, options.h));
  if (options.knn < 0 || options.knn > kMostNearest)
    return usage(fmt::format("knn: found {}, expected 0 to {}", options.knn, kMostNearest));
  if (options.knn > 0 && options.h > 0)
    return usage("h: found with knn, where each query's h follows from its own radius");
  return {};
}

Result<void> check_lattice(const Lattice& lattice) {
  for (std::size_t a = 0; a < 3; ++a) {
    const double step = lattice.scale[a];
    if (!(step > 0 && std::isfinite(step) && std::isfinite(lattice.origin[a])))
      return usage(
          fmt::format("lattice: found steps of {} from {}, expected numbers, steps above 0", step,
                      lattice.origin[a]));
  }
  return {};
}

}  // namespace

Result<void> check_options(const MlsOptions& options) {
  if (options.method.degree < 0 || options.method.degree > 4)
    return usage(fmt::format("degree: found {}, expected 0 to 4", options.method.degree));
  if (options.lattice) PSS_TRY(check_lattice(*options.lattice));
  return check_widths(options);
}

double widest_reach(const MlsWidths& widths, const Method& method) {
  if (widths.nearest == 0) return reach(method.weight, widths.support);
  return std::max(widths.cap, reach(method.weight, support_of_radius(widths.cap, method)));
}

MlsWidths choose_widths(const MlsOptions& options, const SortedCloud& cloud) {
  const auto spacings = [&](double count) { return count * spacing_of(cloud).value_or(0); };
  MlsWidths widths;
  widths.nearest = options.knn;
  if (options.knn > 0) {
    widths.cap = options.radius > 0 ? options.radius : spacings(kCapSpacings);
  } else if (options.radius > 0) {
    widths.support = support_of_radius(options.radius, options.method);
    if (options.h > 0) widths.support.h = options.h;
  } else if (options.h > 0) {
    widths.support = support_of_h(options.h, options.method);
  } else {
    widths.support = support_of_width(spacings(kWidthsPerSpacing), options.method);
  }
  return widths;
}

}  // namespace pss
