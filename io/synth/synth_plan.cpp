#include "io/synth/synth_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "io/synth/synth_random.h"

namespace pss {
namespace {

constexpr double kCorner = 0.25;  // the side of the denser corner in u and v
constexpr double kLargestFraction = 1 - 0x1p-53;
constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15;  // 2^64 / phi
constexpr double kScatter = 0.754877666246692760;      // the inverse of the plastic number

__extension__ using Wide = unsigned __int128;

/// floor(n * share / 2^64).
std::uint64_t part_of(std::uint64_t n, std::uint64_t share) {
  return static_cast<std::uint64_t>(static_cast<Wide>(n) * share >> 64);
}

std::uint64_t multiply_modulo(std::uint64_t a, std::uint64_t b, std::uint64_t n) {
  return static_cast<std::uint64_t>(static_cast<Wide>(a) * b % n);
}

/// A stride over n lattice points that visits all of them.
std::uint64_t stride_over(std::uint64_t n, SynthOrder order) {
  if (n < 2) return 0;
  if (order == SynthOrder::kSweep) return 1;
  auto stride =
      std::max<std::uint64_t>(1, static_cast<std::uint64_t>(kScatter * static_cast<double>(n)));
  while (std::gcd(stride, n) != 1) ++stride;
  return stride % n;
}

/// The place on a turn whose density goes as 1 + wave cos(2 pi x), for an even fraction.
double bend(double fraction, double wave) {
  const double turn = fraction < 0.5 ? fraction : fraction - 1;
  const double bent = solve_kepler(2 * std::numbers::pi * turn, wave) / (2 * std::numbers::pi);
  return std::clamp(bent < 0 ? bent + 1 : bent, 0.0, kLargestFraction);
}

}  // namespace

SynthPlan::SynthPlan(const SynthOptions& options)
    : points_(options.points), scans_(static_cast<std::uint64_t>(options.scans)) {
  const double side = std::sqrt(options.density_gradient);  // along u, and as much along v
  wave_ = (side - 1) / (side + 1);
  for (std::uint64_t scan = 0; scan < scans_; ++scan) patches_.push_back(patches_of(options, scan));
}

std::uint64_t SynthPlan::scan_begin(std::uint64_t scan) const {
  return points_ / scans_ * scan + std::min(scan, points_ % scans_);
}

std::uint64_t SynthPlan::scan_of(std::uint64_t record) const {
  const std::uint64_t larger = points_ % scans_;  // the first scans have one record more
  const std::uint64_t size = points_ / scans_;
  const std::uint64_t border = larger * (size + 1);
  return record < border ? record / (size + 1) : larger + (record - border) / size;
}

/// The rectangles of one density in the strip [begin, begin + width) of u, which may pass 1.
std::vector<SynthPlan::Patch> SynthPlan::cut(const SynthOptions& options, double begin,
                                             double width) {
  if (options.corner_density == 1) return {{.u = begin, .width = width, .weight = width}};
  std::vector<Patch> patches;
  const double end = begin + width;
  for (double low = begin; low < end;) {
    double high = end;
    for (const double border : {kCorner, 1.0, 1 + kCorner})
      if (border > low) high = std::min(high, border);
    const double across = high - low;
    const bool in_corner = low - std::floor(low) < kCorner;
    const double lower = in_corner ? kCorner : 0;
    patches.push_back({.u = low,
                       .v = lower,
                       .width = across,
                       .height = 1 - lower,
                       .weight = across * (1 - lower)});
    if (in_corner)
      patches.push_back({.u = low,
                         .width = across,
                         .height = kCorner,
                         .weight = across * kCorner * options.corner_density});
    low = high;
  }
  return patches;
}

std::vector<SynthPlan::Patch> SynthPlan::patches_of(const SynthOptions& options,
                                                    std::uint64_t scan) const {
  const double width = scans_ == 1 ? 1 : kCoverage;
  const bool closed = closed_in_u(options.surface);
  const double place =
      scans_ == 1 ? 0
                  : static_cast<double>(scan) / static_cast<double>(closed ? scans_ : scans_ - 1);
  std::vector<Patch> patches = cut(options, closed ? place : place * (1 - width), width);

  std::uint64_t left = scan_begin(scan + 1) - scan_begin(scan);
  double weight = 0;
  for (const Patch& patch : patches) weight += patch.weight;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    Patch& patch = patches[i];
    const bool last = i + 1 == patches.size();
    if (!last) patch.share = static_cast<std::uint64_t>(patch.weight / weight * 0x1p64);
    patch.count = last ? left : part_of(left, patch.share);
    left -= patch.count;
    weight -= patch.weight;
    patch.spacing = std::sqrt(patch.width * patch.height /
                              static_cast<double>(std::max<std::uint64_t>(patch.count, 1)));
    patch.step = patch.count > 0 ? ~std::uint64_t{0} / patch.count : 0;
    patch.stride = stride_over(patch.count, options.order);
    patch.shift_u = random_bits(~options.seed, (scan * 64 + i) * 2);
    patch.shift_v = random_bits(~options.seed, (scan * 64 + i) * 2 + 1);
  }
  return patches;
}

void SynthPlan::places(std::uint64_t first, std::span<Place> out) const {
  while (!out.empty()) {
    const std::uint64_t scan = scan_of(first);
    const std::size_t count =
        static_cast<std::size_t>(std::min<std::uint64_t>(out.size(), scan_begin(scan + 1) - first));
    scan_places(scan, first - scan_begin(scan), out.first(count));
    first += count;
    out = out.subspan(count);
  }
}

void SynthPlan::scan_places(std::uint64_t scan, std::uint64_t first, std::span<Place> out) const {
  const std::vector<Patch>& patches = patches_[scan];
  // For every patch the lattice point that comes next.
  std::vector<std::uint64_t> next;
  std::uint64_t rank = first;
  for (const Patch& patch : patches) {
    const std::uint64_t before = &patch == &patches.back() ? rank : part_of(rank, patch.share);
    next.push_back(patch.count > 0 ? multiply_modulo(before, patch.stride, patch.count) : 0);
    rank -= before;
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    // A patch takes every record at which its share of them passes a whole number.
    rank = first + k;
    std::size_t i = 0;
    while (i + 1 < patches.size()) {
      const std::uint64_t before = part_of(rank, patches[i].share);
      if (part_of(rank + 1, patches[i].share) > before) break;
      rank -= before;
      ++i;
    }
    const Patch& patch = patches[i];
    out[k] = place_in(patch, next[i]);
    next[i] += patch.stride;
    if (next[i] >= patch.count) next[i] -= patch.count;
  }
}

Place SynthPlan::place_in(const Patch& patch, std::uint64_t lattice_point) const {
  const double across = unit_fraction(lattice_point * patch.step + patch.shift_u);
  const double up = unit_fraction(lattice_point * kGolden + patch.shift_v);
  double u = patch.u + patch.width * across;
  if (u >= 1) u -= 1;
  u = std::min(u, kLargestFraction);
  const double v = std::min(patch.v + patch.height * up, kLargestFraction);
  if (wave_ == 0) return {u, v, patch.spacing};
  return {bend(u, wave_), bend(v, wave_), patch.spacing};
}

}  // namespace pss
