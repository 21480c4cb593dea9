// How far is single precision, with its redo in double, from double on real scans, and how far is
// double from the plain reference? bench_precision [--method fast] [--degree M] SCAN...

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "core/morton.h"
#include "core/projector.h"
#include "core/sorted_cloud.h"
#include "core/vec3.h"
#include "io/reader.h"

namespace pss {
namespace {

Result<SortedCloud> read_sorted(const std::string& path) {
  PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_reader(path));
  const std::optional<Lattice>& grid = reader->header().grid;
  std::vector<World3> world;
  PointBatch batch;
  do {
    PSS_TRY(reader->read(1 << 16, batch));
    for (const Index3& index : batch.index) world.push_back(to_world(*grid, index));
    world.insert(world.end(), batch.world.begin(), batch.world.end());
  } while (batch.size() > 0);
  return sort_cloud(world, {}, grid);
}

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
  Projector projector(grid, method);
  constexpr std::size_t kBatch = 1024;
  for (std::size_t i = 0; i < queries.size(); i += kBatch) {
    const std::size_t count = std::min(kBatch, queries.size() - i);
    projector.project(std::span(queries).subspan(i, count), {&support, 1},
                      std::span(run.results).subspan(i, count));
  }
  run.seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  return run;
}

/// Distances between two results for the same points, in spacings.
struct Difference {
  std::size_t compared = 0;
  std::size_t statuses = 0;  // that differ
  std::size_t far = 0;       // more than 1e-4 spacings
  double worst = 0;
  double square = 0;

  void add(const Projection& a, const Projection& b, double spacing) {
    statuses += a.status != b.status;
    if (a.status != Status::kOk || b.status != Status::kOk) return;
    const World3 d = a.displacement - b.displacement;
    const double distance = std::sqrt(dot(d, d)) / spacing;
    ++compared;
    far += distance > 1e-4;
    worst = std::max(worst, distance);
    square += distance * distance;
  }

  double rms() const { return compared ? std::sqrt(square / static_cast<double>(compared)) : 0; }
};

/// Double against the plain search, on every so many points.
Difference against_plain(const SortedCloud& cloud, const Support& support, const Method& method,
                         const Run& run, double spacing) {
  constexpr std::size_t kEvery = 17;
  const CellGrid grid(cloud.lattice, cloud.points, reach(method.weight, support));
  Offsets offsets;
  Difference difference;
  for (std::size_t i = 0; i < cloud.points.size(); i += kEvery) {
    grid.gather({cloud.points[i], {}}, reach(method.weight, support), offsets);
    difference.add(run.results[i], project_point(offsets, support, method), spacing);
  }
  return difference;
}

Result<void> compare(const std::string& path, Method method) {
  PSS_ASSIGN(const SortedCloud cloud, read_sorted(path));
  const std::optional<double> spacing = spacing_of(cloud);
  if (!spacing) return Error{Fault::kBadInput, fmt::format("{}: too few points", path)};
  const double h = 2 * *spacing;
  const Support support{h, radius_factor(method.degree) * h};
  method.precision = Precision::kDouble;
  const Run twice = project(cloud, support, method);
  const Difference plain = against_plain(cloud, support, method, twice, *spacing);
  method.precision = Precision::kSingle;
  const Run single = project(cloud, support, method);

  Difference difference;
  double neighbours = 0;
  std::size_t redone = 0, moved_points = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    difference.add(single.results[i], twice.results[i], *spacing);
    neighbours += single.results[i].neighbours;
    redone += single.results[i].redone;
    moved_points += moved(single.results[i].status);
  }
  const auto n = static_cast<double>(cloud.points.size());
  fmt::print(
      "| {} | {} | {:.0f} | {:.1f} % | {:.2f} % | {} | {:.2g} | {:.1e} | {} | {:.1e} | "
      "{:.0f} k | {:.0f} k |\n",
      path.substr(path.rfind('/') + 1), cloud.points.size(), neighbours / n,
      100 * static_cast<double>(moved_points) / n, 100 * static_cast<double>(redone) / n,
      difference.far, difference.worst, difference.rms(), difference.statuses, plain.worst,
      n / single.seconds / 1e3, n / twice.seconds / 1e3);
  return {};
}

int run(std::vector<std::string> arguments) {
  Method method;
  const auto take = [&](const std::string& flag) -> std::string {
    const auto at = std::ranges::find(arguments, flag);
    if (at == arguments.end() || at + 1 == arguments.end()) return "";
    const std::string value = at[1];
    arguments.erase(at, at + 2);
    return value;
  };
  if (take("--method") == "fast") method.op = MlsOperator::kFast;
  if (const std::string degree = take("--degree"); !degree.empty())
    method.degree = std::atoi(degree.c_str());
  fmt::print("{}, {}, order {}, h = 2 s, one thread; distances in spacings\n\n", name_of(method.op),
             name_of(method.weight), method.degree);
  fmt::print(
      "| scan | points | neighbours | moved | redone | farther than 1e-4 | worst | rms | "
      "statuses differ | double to plain, worst | single, points/s | double |\n"
      "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
  for (const std::string& path : arguments) {
    const Result<void> done = compare(path, method);
    if (done) continue;
    fmt::print(stderr, "{}\n", done.error().message);
    return 1;
  }
  return 0;
}

}  // namespace
}  // namespace pss

int main(int argc, char** argv) { return pss::run({argv + 1, argv + argc}); }
