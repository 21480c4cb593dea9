#include "core/surface_gate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/fit_kernel.h"

namespace pss {
namespace {

constexpr double kLeastFreedom =
    0.3;  ///< 1 - K / n at the fewest neighbours that are corrected for

}  // namespace

/// At n neighbours in the disc of the radius, a sample takes pi R^2 / n of it.
SurfaceGate::SurfaceGate(const Method& method, double radius_over_h)
    : parameters_(FitKernel(method.weight, method.degree, radius_over_h).absorbed() *
                  std::numbers::pi * radius_over_h * radius_over_h) {}

double SurfaceGate::residual(const Projection& projection) const {
  const double freedom =
      1 - parameters_ / std::max(1.0, static_cast<double>(projection.neighbours));
  return projection.residual / std::sqrt(std::max(kLeastFreedom, freedom));
}

}  // namespace pss
