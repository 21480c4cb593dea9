// How many points a second does one core project, and how does that fall with the neighbours?

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/morton.h"
#include "core/neighbours.h"
#include "core/projection.h"

namespace pss {
namespace {

constexpr std::size_t kPoints = 100000;
const Lattice kLattice{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};

/// An evenly sampled wave of spacing 1, with a little unevenness in height, in key order.
std::vector<Index3> wave() {
  const double side = std::sqrt(static_cast<double>(kPoints));
  std::vector<Index3> points;
  for (std::size_t i = 0; i < kPoints; ++i) {
    const double n = static_cast<double>(i);
    const double x = side * std::fmod(n * 0.7548776662466927, 1.0);
    const double y = side * std::fmod(n * 0.5698402909980532, 1.0);
    const double z =
        4 * std::sin(x / 30) * std::cos(y / 25) + 0.2 * std::fmod(n * 0.6180339887, 1.0);
    points.push_back(to_index(kLattice, {x, y, z}));
  }
  std::sort(points.begin(), points.end(),
            [](const Index3& a, const Index3& b) { return encode_key(a) < encode_key(b); });
  return points;
}

/// The support whose ball holds so many neighbours on a surface of spacing 1.
Support support_for(double neighbours, int degree) {
  const double radius = std::sqrt(neighbours / std::numbers::pi);
  return {radius / radius_factor(degree), radius};
}

void report(benchmark::State& state, std::uint64_t points, std::uint64_t neighbours) {
  state.counters["points/s"] =
      benchmark::Counter(static_cast<double>(points), benchmark::Counter::kIsRate);
  state.counters["neighbours/s"] =
      benchmark::Counter(static_cast<double>(neighbours), benchmark::Counter::kIsRate);
  state.counters["neighbours"] = static_cast<double>(neighbours) / static_cast<double>(points);
}

void project_points(benchmark::State& state) {
  const int degree = static_cast<int>(state.range(0));
  const Support support = support_for(static_cast<double>(state.range(1)), degree);
  const std::vector<Index3> points = wave();
  const CellGrid grid(kLattice, points, reach(support));
  Offsets offsets;
  std::uint64_t done = 0, neighbours = 0;
  for (auto _ : state) {
    grid.gather({points[done * 7919 % kPoints], {}}, reach(support), offsets);
    const Projection projection = project_point(offsets, support, {.degree = degree});
    neighbours += projection.neighbours;
    ++done;
  }
  report(state, done, neighbours);
}
BENCHMARK(project_points)
    ->ArgNames({"degree", "neighbours"})
    ->ArgsProduct({{3}, {15, 30, 60, 113, 250}})
    ->ArgsProduct({{0, 1, 2, 4}, {113}});

/// What finding the neighbours alone takes of that.
void gather_neighbours(benchmark::State& state) {
  const Support support = support_for(static_cast<double>(state.range(0)), 3);
  const std::vector<Index3> points = wave();
  const CellGrid grid(kLattice, points, reach(support));
  Offsets offsets;
  std::uint64_t done = 0, neighbours = 0;
  for (auto _ : state) {
    grid.gather({points[done * 7919 % kPoints], {}}, reach(support), offsets);
    neighbours += offsets.size();
    ++done;
  }
  report(state, done, neighbours);
}
BENCHMARK(gather_neighbours)->ArgName("neighbours")->Arg(30)->Arg(113);

}  // namespace
}  // namespace pss
