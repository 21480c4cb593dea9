#pragma once
// Where the records of a synthetic scan lie on the unit square that is mapped onto the surface.

#include <cstdint>
#include <span>
#include <vector>

#include "io/synth/synth_options.h"

namespace pss {

/// The part of the surface that one of several scans covers.
inline constexpr double kCoverage = 0.75;

/// A place of the unit square, and the spacing about it where the square has the area 1.
struct Place {
  double u = 0;
  double v = 0;
  double spacing = 0;
};

/// The places of all records, computed from their number alone.
///
/// Every patch (a rectangle of one density) holds a golden lattice, (j / n, j / phi) mod 1. Its
/// shortest distance stays above 0.94 mean spacings under every stretching that keeps areas, so
/// that all surfaces are sampled evenly. A stride scatters consecutive records.
/// Source: Swinbank, Purser, "Fibonacci grids", 2006, for the lattice.
class SynthPlan {
 public:
  explicit SynthPlan(const SynthOptions& options);

  /// The first record of a scan; scans follow one another.
  std::uint64_t scan_begin(std::uint64_t scan) const;
  std::uint64_t scan_of(std::uint64_t record) const;

  /// The places of the records from `first` on.
  ///
  /// Thread: any number at once.
  void places(std::uint64_t first, std::span<Place> out) const;

 private:
  struct Patch {
    double u = 0, v = 0, width = 1, height = 1;
    double weight = 0;        ///< area times density
    std::uint64_t share = 0;  ///< of the records that the patches before have left, over 2^64
    std::uint64_t count = 0;
    double spacing = 0;
    std::uint64_t step = 0;    ///< 2^64 / count
    std::uint64_t stride = 0;  ///< from a record's lattice point to the next one's, modulo count
    std::uint64_t shift_u = 0, shift_v = 0;  ///< over 2^64
  };

  std::vector<Patch> patches_of(const SynthOptions& options, std::uint64_t scan) const;
  static std::vector<Patch> cut(const SynthOptions& options, double begin, double width);
  void scan_places(std::uint64_t scan, std::uint64_t first, std::span<Place> out) const;
  Place place_in(const Patch& patch, std::uint64_t lattice_point) const;

  std::uint64_t points_ = 0;
  std::uint64_t scans_ = 1;
  double wave_ = 0;  ///< of the density: 1 + wave cos(2 pi u), and the same along v
  std::vector<std::vector<Patch>> patches_;
};

}  // namespace pss
