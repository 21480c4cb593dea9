#include "stream/widths/width_trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "core/projector.h"
#include "core/support.h"
#include "core/vec3.h"
#include "stream/widths/sheets.h"
#include "stream/widths/surroundings.h"

namespace pss {
namespace {

constexpr std::size_t kTrials = kTriedWidths.size();
constexpr double kIsolatedMedians = 16;  ///< a d16 beyond so many medians tells of an outlier
constexpr double kInside = 0.3;          ///< of the boundary value: 0.56 on a straight edge
constexpr double kCrowded = 4;           ///< neighbours over those of a surface: a volume

/// A position that is looked at, and its unit of length.
struct Sampled {
  Index3 position{};
  double unit = 0;
};

/// Every n-th of the sample, so that it stays spread along the order of keys.
std::vector<Sampled> chosen_of(const SpacingSample& sample) {
  const Spacing& spacing = *sample.spacing;
  const std::size_t step = (sample.points.size() + kNoiseSample - 1) / kNoiseSample;
  std::vector<Sampled> chosen;
  for (std::size_t i = 0; i < sample.points.size(); i += step) {
    const auto& [position, d16] = sample.points[i];
    if (d16 > kIsolatedMedians * spacing.d16) continue;
    chosen.push_back({position, spacing.varying() ? spacing_of_d16(d16) : spacing.spacing});
  }
  return chosen;
}

double larger_curvature(const Projection& p) {
  const double h = std::abs(p.mean_curvature);
  return h + std::sqrt(std::max(0.0, h * h - p.gaussian_curvature));
}

/// Projects groups of sampled positions at every width.
class Trials {
 public:
  Trials(const Lattice& lattice, std::span<const Sampled> sampled, const Method& method)
      : lattice_(lattice),
        sampled_(sampled),
        method_{MlsOperator::kFast, method.weight, Precision::kDouble, method.degree} {}

  Support support(double unit, std::size_t trial) const {
    return support_of_width(kTriedWidths[trial] * unit, method_);
  }

  void add(const Surroundings& around) {
    const std::span<const Sampled> group = sampled_.subspan(around.first, around.count);
    const CellGrid grid(lattice_, around.points, kTriedWidths[1] * 3 * group.front().unit);
    const std::vector<std::vector<Projection>> projections = project(grid, group);
    for (std::size_t i = 0; i < group.size(); ++i) {
      const auto& [position, unit] = group[i];
      const std::optional<double> sheet =
          other_sheet(grid, position, unit, kWidthsApart * kTriedWidths.back());
      if (sheet) readings_.sheets.push_back(*sheet);
      for (std::size_t k = 0; k < kTrials; ++k) {
        const Projection* const next = k + 1 < kTrials ? &projections[k + 1][i] : nullptr;
        readings_.at[k].push_back(reading(unit, k, projections[k][i], next, sheet));
      }
    }
  }

  Readings readings() { return std::move(readings_); }

 private:
  /// By width, then by position; what is crowded at one width is not tried at the next.
  std::vector<std::vector<Projection>> project(const CellGrid& grid,
                                               std::span<const Sampled> group) const {
    Projector projector(grid, method_);
    std::vector<std::vector<Projection>> projections(kTrials,
                                                     std::vector<Projection>(group.size()));
    std::vector<std::size_t> tried(group.size());
    std::iota(tried.begin(), tried.end(), std::size_t{0});
    for (std::size_t k = 0; k < kTrials; ++k) {
      std::vector<Query> queries;
      std::vector<Support> supports;
      for (const std::size_t i : tried) {
        queries.push_back({group[i].position, {}});
        supports.push_back(support(group[i].unit, k));
      }
      std::vector<Projection> found(tried.size());
      projector.project(queries, supports, found);
      for (std::size_t i = 0; i < tried.size(); ++i) projections[k][tried[i]] = found[i];
      std::erase_if(tried, [&](std::size_t i) { return crowded(projections[k][i], k); });
    }
    return projections;
  }

  /// Whether there are far more neighbours than a surface has.
  bool crowded(const Projection& p, std::size_t trial) const {
    const double radius = support(1, trial).radius;
    return p.neighbours > kCrowded * std::numbers::pi * radius * radius;
  }

  static bool usable(const Projection& p) {
    return p.status == Status::kOk && p.boundary < kInside;
  }

  Reading reading(double unit, std::size_t trial, const Projection& p, const Projection* next,
                  std::optional<double> sheet) const {
    Reading reading;
    reading.usable = usable(p);
    if (!reading.usable) return reading;
    const auto disturbed = [&](std::size_t k) {
      return sheet && *sheet < kWidthsApart * kTriedWidths[k];
    };
    const Support support = this->support(1, trial);
    const double residual = p.residual / unit;
    reading.disturbed = disturbed(trial);
    reading.residual_sq = residual * residual;
    reading.area = std::numbers::pi * support.radius * support.radius / p.neighbours;
    reading.bend = kTriedWidths[trial] * unit * larger_curvature(p);
    if (next && usable(*next) && !disturbed(trial + 1)) {
      const double change = dot(next->displacement - p.displacement, p.normal) / unit;
      reading.change_sq = change * change;
    }
    return reading;
  }

  Lattice lattice_;
  std::span<const Sampled> sampled_;
  Method method_;
  Readings readings_;
};

}  // namespace

std::uint64_t width_memory() { return Projector::bytes_for(kMostAround) + surroundings_memory(); }

Result<Readings> try_widths(const Source& source, const SpacingSample& sample, const Method& method,
                            MemoryBudget& budget, Monitor& monitor) {
  const std::vector<Sampled> sampled = chosen_of(sample);
  Trials trials(source.lattice(), sampled, method);
  std::vector<Site> sites;
  for (const auto& [position, unit] : sampled)
    sites.push_back({position, reach(method.weight, trials.support(unit, kTrials - 1))});
  const std::uint64_t bytes = Projector::bytes_for(kMostAround);
  const auto memory = budget.reserve(bytes);
  if (!memory) return budget.refusal("measuring the noise", width_memory(), ", or --h");
  PSS_TRY(for_each_surroundings(source, sites, budget, monitor,
                                [&](const Surroundings& around) { trials.add(around); }));
  return trials.readings();
}

}  // namespace pss
