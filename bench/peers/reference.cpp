#include <fmt/format.h>

#include <cmath>

#include "bench/distances.h"
#include "bench/peers/modes.h"
#include "bench/read_scan.h"
#include "core/support.h"
#include "tests/support/projection_oracle.h"

namespace pss::bench {
namespace {

constexpr std::size_t kSample = 2000;

/// A scan, its spacing, and the points on which the slow references are computed.
class Sampled {
 public:
  Sampled(SortedCloud cloud, double spacing) : cloud_(std::move(cloud)), spacing_(spacing) {
    const std::size_t step = (cloud_.points.size() + kSample - 1) / kSample;
    for (std::size_t i = 0; i < cloud_.points.size(); i += step) rows_.push_back(i);
  }

  double spacing() const { return spacing_; }
  std::size_t size() const { return rows_.size(); }

  std::vector<Projection> by_reference(const Method& method, const Support& support) const {
    const double radius = reach(method.weight, support);
    const CellGrid grid(cloud_.lattice, cloud_.points, radius);
    Offsets near;
    std::vector<World3> offsets;
    std::vector<Projection> results;
    for (const std::size_t row : rows_) {
      grid.gather({cloud_.points[row], {}}, radius, near);
      offsets.clear();
      for (std::size_t i = 0; i < near.size(); ++i)
        offsets.push_back({near.x[i], near.y[i], near.z[i]});
      results.push_back(test::project_by_oracle<long double>(offsets, support, method));
    }
    return results;
  }

  std::vector<Projection> by_kernels(const Method& method, const Support& support) const {
    const CellGrid grid(cloud_.lattice, cloud_.points, reach(method.weight, support));
    std::vector<Query> queries;
    for (const std::size_t row : rows_) queries.push_back({cloud_.points[row], {}});
    std::vector<Projection> results(queries.size());
    Projector(grid, method).project(queries, {&support, 1}, results);
    return results;
  }

  /// How a peer, given coordinates about the scan's centre, moves the sampled points.
  std::vector<World3> by_peer(const Contender& peer, const Task& task) const {
    IndexBox box;
    for (const Index3& p : cloud_.points) box.add(p);
    Points points{spacing_, cloud_.lattice, cloud_.points};
    for (std::size_t a = 0; a < 3; ++a)
      points.lattice.origin[a] =
          -points.lattice.scale[a] * static_cast<double>((box.min[a] + box.max[a]) / 2);
    const Smoothed smoothed = peer.smooth(points, task);
    std::vector<World3> moves;
    for (const std::size_t row : rows_)
      moves.push_back(smoothed.positions[row] - to_world(points.lattice, points.points[row]));
    return moves;
  }

 private:
  SortedCloud cloud_;
  double spacing_;
  std::vector<std::size_t> rows_;
};

void print(const std::string& scan, const std::string& what, const Distances& distances) {
  fmt::print("| {} | {} | {} | {} | {:.1e} | {:.1e} | {:.2f} % |\n", scan, what,
             distances.compared(), distances.statuses(), distances.worst(), distances.rms(),
             100 * static_cast<double>(distances.elsewhere()) /
                 static_cast<double>(std::max<std::size_t>(distances.compared(), 1)));
}

/// The kernels in both precisions; gives the reference.
std::vector<Projection> compare_kernels(const std::string& scan, const Sampled& sampled,
                                        const Support& support, Method method) {
  std::vector<Projection> reference = sampled.by_reference(method, support);
  for (const Precision precision : {Precision::kDouble, Precision::kSingle}) {
    method.precision = precision;
    const std::vector<Projection> results = sampled.by_kernels(method, support);
    Distances distances(sampled.spacing());
    for (std::size_t i = 0; i < results.size(); ++i) distances.add(results[i], reference[i]);
    print(scan,
          fmt::format("pss {}, weight {}, {}", name_of(method.op), name_of(method.weight),
                      name_of(precision)),
          distances);
  }
  return reference;
}

Result<void> compare_on(const Settings& settings, const std::string& path) {
  PSS_ASSIGN(SortedCloud cloud, read_scan(path));
  const std::optional<double> spacing = spacing_of(cloud);
  if (!spacing) return Error{Fault::kBadInput, fmt::format("{}: too few points", path)};
  const Sampled sampled(std::move(cloud), *spacing);
  const double radius = settings.radii.back() * *spacing;
  const std::string scan = file_name(path);
  for (const auto& [op, weight] : {std::pair{MlsOperator::kLevin, WeightKind::kGaussian},
                                   {MlsOperator::kFast, WeightKind::kPcl}}) {
    const Method method{op, weight, Precision::kDouble, settings.degree};
    const auto reference =
        compare_kernels(scan, sampled, support_of_radius(radius, method), method);
    if (weight != WeightKind::kPcl) continue;
    Contenders peers;
#ifdef PSS_HAVE_PCL
    add_pcl(peers);
#endif
    for (const auto& peer : peers) {
      const std::vector<World3> moves = sampled.by_peer(*peer, {radius, settings.degree, 1});
      Distances distances(*spacing);
      for (std::size_t i = 0; i < moves.size(); ++i)
        if (reference[i].status == Status::kOk && std::isfinite(moves[i][0]))
          distances.add(moves[i] - reference[i].displacement);
      print(scan, peer->name(), distances);
    }
  }
  return {};
}

}  // namespace

Result<void> compare_with_reference(const Settings& settings,
                                    const std::vector<std::string>& scans) {
  fmt::print(
      "Distances in spacings to the reference of the same operator and weight, R = {} s, order "
      "{};\n"
      "PCL's to that of `fast` with its weight.\n\n"
      "| scan | | points ok in both | statuses differ | worst | rms | farther than 0.01 |\n"
      "|---|---|--:|--:|--:|--:|--:|\n",
      settings.radii.back(), settings.degree);
  for (const std::string& path : scans) PSS_TRY(compare_on(settings, path));
  return {};
}

}  // namespace pss::bench
