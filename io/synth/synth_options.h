#pragma once
// What a synthetic scan is made of, and what that says about the true surface.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/lattice.h"
#include "core/result.h"
#include "core/shapes.h"

namespace pss {

/// The order of the records within a scan.
enum class SynthOrder : std::uint8_t {
  kScattered,  ///< consecutive records lie far apart
  kSweep,      ///< a front that moves over the surface, as scanners do
};

struct SynthOptions {
  Surface surface = Torus{};
  std::uint64_t points = 1'000'000;  ///< of all scans together
  int scans = 1;                     ///< each covers three quarters of the surface, one covers all
  double noise = 0;                  ///< standard deviation along the normal, in mean spacings
  double jitter = 0.25;              ///< how far samples are off a lattice, in the scan's spacings
  double corner_density = 1;         ///< of a sixteenth of the surface, over that of the rest
  double density_gradient = 1;       ///< of the densest place over the sparsest, changing smoothly
  World3 offset{0, 0, 0};            ///< added to all coordinates
  std::uint64_t seed = 1;
  std::optional<double> scale;  ///< the step of the positions; default_scale() where not given
  bool time = true;             ///< GpsTime, without which a LAS record has 20 bytes
  bool truth = false;           ///< adds TrueX TrueY TrueZ (before noise) and TrueDistance
  SynthOrder order = SynthOrder::kScattered;
};

/// The mean distance between samples: the root of area / points (of one point where there is none).
double spacing(const SynthOptions& options);
/// The power of ten at or below a thousandth of the spacing.
double default_scale(double spacing);
/// The grid that positions are rounded to: its origin is the offset.
Lattice grid(const SynthOptions& options);

/// Errors: kUsage, naming the option that makes no sense.
Result<void> check(const SynthOptions& options);

/// The surface of a name with its sizes; those not given have a default.
///
/// Shape:  torus: major and minor radius; sphere: radius; plane: width, depth and the slopes along
///         x and y; terrain: width, depth.
/// Errors: kUsage for an unknown name, too many sizes, or one that makes no surface.
Result<Surface> make_surface(std::string_view name, const std::vector<double>& sizes);

/// The true surface and how it was sampled, as a JSON object; lengths in the scan's units.
std::string parameters_json(const SynthOptions& options);

}  // namespace pss
