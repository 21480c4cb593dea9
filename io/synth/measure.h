#pragma once
// How far the points of a file are from the surface that they were synthesised from.

#include <cstdint>
#include <optional>
#include <string>

#include "core/monitor.h"
#include "io/points/reader.h"
#include "io/synth/magnitudes.h"
#include "io/synth/synth_options.h"

namespace pss {

/// What became of a surface: distances of points, and errors of what the file says of it.
///
/// Units: distances and curvatures (1/length) in the scan's, normals in radians.
struct Measurement {
  Magnitudes distance;                       ///< signed, positive on the normal's side
  std::uint64_t not_finite = 0;              ///< points without a place or distance; not measured
  std::optional<Magnitudes> normal;          ///< angle to the true normal up to sign
  std::optional<Magnitudes> mean_curvature;  ///< difference from the true one
  std::optional<Magnitudes> gaussian_curvature;
};

/// Measures every point of a file against the true surface of `truth`.
///
/// Attributes are measured where the file has them: NormalX NormalY NormalZ (or nx ny nz),
/// MeanCurvature (its sign goes with the file's normal, or without one with the canonical normal,
/// whose largest component is positive) and GaussianCurvature. A point whose normal is zero, or
/// that has a Status and stayed, says nothing of either.
///
/// Errors: those of reading; kInterrupted.
/// Cost:   one pass, some megabytes; the sums do not depend on threads.
Result<Measurement> measure(Reader& reader, const SynthOptions& truth, Monitor& monitor);

/// The measurement as a JSON object, lengths in units and in spacings.
std::string measurement_json(const Measurement& measurement, const SynthOptions& truth);
/// The same as a table for people.
std::string measurement_table(const Measurement& measurement, const SynthOptions& truth);

}  // namespace pss
