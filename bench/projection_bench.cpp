// How many points a second does one core project: by operator, degree, precision, vector target
// and number of neighbours; and what are the grid and the search for candidates of that?

#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/morton.h"
#include "core/neighbours.h"
#include "core/projector.h"
#include "core/simd/targets.h"
#include "core/vec3.h"

namespace pss {
namespace {

constexpr std::size_t kPoints = 100000;
constexpr std::size_t kBatch = 1024;
const Lattice kLattice{{1e-4, 1e-4, 1e-4}, {0, 0, 0}};

/// An evenly sampled wave of spacing 1, with a little unevenness in height, in key order.
std::vector<Index3> make_wave() {
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
  std::ranges::sort(points, {}, encode_key);
  return points;
}

const std::vector<Index3>& wave() {
  static const std::vector<Index3> points = make_wave();
  return points;
}

/// The normals of the wave without its unevenness.
std::vector<Normal> wave_normals() {
  std::vector<Normal> normals;
  for (const Index3& index : wave()) {
    const World3 p = to_world(kLattice, index);
    const World3 n = normalized({-4.0 / 30 * std::cos(p[0] / 30) * std::cos(p[1] / 25),
                                 4.0 / 25 * std::sin(p[0] / 30) * std::sin(p[1] / 25), 1});
    normals.push_back(
        {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
  }
  return normals;
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

void project(benchmark::State& state, const Method& method, double wanted) {
  const Support support = support_for(wanted, method.degree);
  const std::vector<Index3>& points = wave();
  static const std::vector<Normal> normals = wave_normals();
  const CellGrid grid(kLattice, points, reach(method.weight, support));
  Projector projector(grid, method, {normals, true});
  std::vector<Query> queries(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) queries[i].position = points[i];
  std::vector<Projection> results(kBatch);
  std::uint64_t done = 0, neighbours = 0;
  std::size_t next = 0;
  for (auto _ : state) {
    projector.project(std::span(queries).subspan(next, kBatch), {&support, 1}, results);
    for (const Projection& p : results) neighbours += p.neighbours;
    done += kBatch;
    next = (next + kBatch) % (points.size() - kBatch);
  }
  report(state, done, neighbours);
}

/// The best target, levin and fast: neighbours and precision.
void project_points(benchmark::State& state) {
  project(state,
          {kMlsOperators[static_cast<std::size_t>(state.range(0))], WeightKind::kGaussian,
           static_cast<Precision>(state.range(1)), static_cast<int>(state.range(2))},
          static_cast<double>(state.range(3)));
}
BENCHMARK(project_points)
    ->ArgNames({"operator", "single", "degree", "neighbours"})
    ->ArgsProduct({{0, 1, 2, 3}, {0, 1}, {3}, {15, 30, 60, 113, 250}})
    ->ArgsProduct({{0, 1}, {0, 1}, {0, 1, 2, 4}, {113}});

/// levin by weight.
void project_by_weight(benchmark::State& state) {
  project(state,
          {MlsOperator::kLevin, kWeightKinds[static_cast<std::size_t>(state.range(0))],
           Precision::kSingle, 3},
          113);
}
BENCHMARK(project_by_weight)->ArgName("weight")->DenseRange(0, 2);

/// levin, order 3, in each target that this machine runs.
void project_by_target(benchmark::State& state) {
  const std::vector<simd::Target> targets = simd::targets();
  const auto wanted = static_cast<std::size_t>(state.range(0));
  if (wanted >= targets.size()) return state.SkipWithError("this machine has no such target");
  state.SetLabel(targets[wanted].name);
  const simd::ForcedTarget forced(targets[wanted]);
  project(state,
          {MlsOperator::kLevin, WeightKind::kGaussian, static_cast<Precision>(state.range(1)), 3},
          113);
}
BENCHMARK(project_by_target)->ArgNames({"target", "single"})->ArgsProduct({{0, 1, 2}, {0, 1}});

/// The cells alone.
void build_grid(benchmark::State& state) {
  const double reach_wanted = reach(support_for(static_cast<double>(state.range(0)), 3));
  for (auto _ : state) benchmark::DoNotOptimize(CellGrid(kLattice, wave(), reach_wanted));
  report(state, state.iterations() * kPoints, 0);
}
BENCHMARK(build_grid)->ArgName("neighbours")->Arg(30)->Arg(113);

}  // namespace
}  // namespace pss
