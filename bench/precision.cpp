// How far is single precision, with its redo in double, from double on real scans?
// bench_precision [--operator NAME] [--weight NAME] [--degree M] SCAN...

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

#include "bench/distances.h"
#include "bench/read_scan.h"
#include "core/projector.h"
#include "core/support.h"

namespace pss::bench {
namespace {

struct Run {
  std::vector<Projection> results;
  double seconds = 0;
};

Run project(const SortedCloud& cloud, const Support& support, const Method& method) {
  std::vector<Query> queries;
  for (const Index3& p : cloud.points) queries.push_back({p, {}});
  Run run;
  run.results.resize(queries.size());
  const std::clock_t start = std::clock();  // of the processor: the machine may be shared
  const CellGrid grid(cloud.lattice, cloud.points, reach(method.weight, support));
  Projector projector(grid, method, {cloud.normals, false});
  constexpr std::size_t kBatch = 1024;
  for (std::size_t i = 0; i < queries.size(); i += kBatch) {
    const std::size_t count = std::min(kBatch, queries.size() - i);
    projector.project(std::span(queries).subspan(i, count), {&support, 1},
                      std::span(run.results).subspan(i, count));
  }
  run.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return run;
}

/// Those of a first pass, the same for both precisions.
void add_normals(SortedCloud& cloud, const Support& support, Method method) {
  method.precision = Precision::kDouble;
  for (const Projection& p : project(cloud, support, normals_method(method)).results)
    cloud.normals.push_back(unit_normal(p.normal));
}

Result<void> compare(const std::string& path, Method method) {
  PSS_ASSIGN(SortedCloud cloud, read_scan(path));
  const std::optional<double> spacing = spacing_of(cloud);
  if (!spacing) return Error{Fault::kBadInput, fmt::format("{}: too few points", path)};
  const Support support = support_of_width(2 * *spacing, method);
  if (needs_normals(method.op)) add_normals(cloud, support, method);
  method.precision = Precision::kDouble;
  const Run twice = project(cloud, support, method);
  method.precision = Precision::kSingle;
  const Run single = project(cloud, support, method);

  Distances distances(*spacing);
  double neighbours = 0;
  std::size_t redone = 0, moved_points = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    distances.add(single.results[i], twice.results[i]);
    neighbours += single.results[i].neighbours;
    redone += single.results[i].redone;
    moved_points += moved(single.results[i].status);
  }
  const auto n = static_cast<double>(cloud.points.size());
  fmt::print(
      "| {} | {} | {:.0f} | {:.1f} % | {:.2f} % | {} | {:.2g} | {:.1e} | {} | {:.0f} k | "
      "{:.0f} k |\n",
      file_name(path), cloud.points.size(), neighbours / n,
      100 * static_cast<double>(moved_points) / n, 100 * static_cast<double>(redone) / n,
      distances.far(), distances.worst(), distances.rms(), distances.statuses(),
      n / single.seconds / 1e3, n / twice.seconds / 1e3);
  return {};
}

template <class Values>
CLI::IsMember names_of(const Values& values) {
  std::vector<std::string> names;
  for (const auto value : values) names.push_back(name_of(value));
  return CLI::IsMember(names);
}

template <class Values>
auto named(const Values& values, const std::string& name) {
  return *std::ranges::find_if(values, [&](auto value) { return name == name_of(value); });
}

int main_of(int argc, char** argv) {
  CLI::App app("Compares single with double precision on scans", "bench_precision");
  std::string op = name_of(MlsOperator::kLevin);
  std::string weight = name_of(WeightKind::kGaussian);
  Method method;
  std::vector<std::string> paths;
  app.add_option("--operator", op)->check(names_of(kMlsOperators));
  app.add_option("--weight", weight)->check(names_of(kWeightKinds));
  app.add_option("--degree", method.degree)->check(CLI::Range(0, 4));
  app.add_option("scan", paths)->required();
  CLI11_PARSE(app, argc, argv);
  method.op = named(kMlsOperators, op);
  method.weight = named(kWeightKinds, weight);

  fmt::print("{}, {}{}, h = 2 s, one thread; distances in spacings\n\n", op, weight,
             needs_normals(method.op) ? "" : fmt::format(", order {}", method.degree));
  fmt::print(
      "| scan | points | neighbours | moved | redone | farther than 1e-4 | worst | rms | "
      "statuses differ | single, points/s | double |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const std::string& path : paths) {
    const Result<void> done = compare(path, method);
    if (done) continue;
    fmt::print(stderr, "{}\n", done.error().message);
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace pss::bench

int main(int argc, char** argv) { return pss::bench::main_of(argc, argv); }
