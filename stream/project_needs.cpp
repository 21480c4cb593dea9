// What parts of a projection need: how far they look, and how much memory that takes.

#include <algorithm>

#include "core/parallel.h"
#include "stream/ball_bound.h"
#include "stream/project.h"

namespace pss {
namespace {

/// What is reserved for the points of a ball before they are counted: twelve times as many as lie
/// within reach of a point at h = 2 spacings.
constexpr std::uint64_t kUsualBall = 2048;

}  // namespace

Support ProjectOperator::support_at(double distance) const {
  const double radius = parameters_.factor * distance;
  return {radius / radius_factor(parameters_.method.degree), radius};
}

double ProjectOperator::reach_of(const Support& support) const {
  return reach(parameters_.method.weight, support);
}

double ProjectOperator::largest_reach() const {
  if (!parameters_.nearest) return reach_of(parameters_.support);
  return std::max(parameters_.cap, reach_of(support_at(parameters_.cap)));
}

double ProjectOperator::usual_reach() const {
  return parameters_.nearest ? reach_of(support_at(parameters_.first_guess)) : largest_reach();
}

double ProjectOperator::first_reach() const {
  if (parameters_.buffer) return *parameters_.buffer;
  if (!parameters_.nearest) return largest_reach();
  // Half more than the typical query needs: most parts are certified at the first loading.
  return std::min(largest_reach(), 1.5 * usual_reach());
}

std::uint64_t ProjectOperator::bytes(const PartPlan& plan) const {
  const std::uint64_t row = bytes_per_row();
  const std::uint64_t own = sizeof(Index3) + row + (parameters_.nearest ? sizeof(Support) : 0);
  // The result is compressed when the question how many points a ball may hold is long answered.
  const std::uint64_t encoded = plan.own_points * (row + sizeof(Index3) + row / 64 + 1);
  const std::uint64_t cells = ball_bound_bytes(plan.near_points);
  return plan.own_points * own + std::max(encoded, cells) +
         plan.near_points * bytes_per_candidate() + CellGrid::bytes_for(plan.near_points) +
         bytes_for_tasks(plan);
}

std::uint64_t ProjectOperator::bytes_for_tasks(const PartPlan& plan) const {
  const std::uint64_t chunks = plan.own_points / kChunkPoints + plan.own.size();
  const std::uint64_t tasks = std::min(static_cast<std::uint64_t>(thread_count()), chunks);
  const std::uint64_t ball = largest_reach() > 0 ? reserved_ball(plan.range, plan.ball_points) : 0;
  return tasks *
         (Projector::bytes_for(ball, parameters_.method.op) + QueryBatch::bytes_for(kChunkPoints));
}

std::uint64_t ProjectOperator::reserved_ball(const PartRange& range, std::uint64_t by_blocks) {
  return std::min(by_blocks, range.ball_points ? range.ball_points : kUsualBall);
}

std::uint64_t ProjectOperator::bytes_per_candidate() const {
  if (!needs_normals(parameters_.method.op)) return sizeof(Index3);
  const std::uint64_t both = sizeof(Index3) + sizeof(Normal);
  // A source that has another order is sorted by way of an order and a copy.
  return both + (source_ordered_ ? 0 : sizeof(std::uint32_t) + sizeof(Index3));
}

std::optional<PartRange> ProjectOperator::prepare(Part& part) const {
  if (part.own.empty() || largest_reach() <= 0) return std::nullopt;
  PartRange needed = part.range;
  if (parameters_.nearest) {
    const double reach = std::min(find_supports(part), largest_reach());
    if (reach > needed.reach && !parameters_.buffer) {
      needed.reach = reach;
      return needed;
    }
  }
  const std::uint64_t reserved = reserved_ball(part.range, part.ball_points);
  const std::uint64_t bound =
      ball_bound(source_lattice_, part.candidates, widest_reach(part), reserved);
  if (std::min(bound, part.ball_points) <= reserved) return std::nullopt;
  needed.ball_points = bound;
  return needed;
}

double ProjectOperator::widest_reach(const Part& part) const {
  if (!parameters_.nearest) return std::min(largest_reach(), part.range.reach);
  double widest = 0;
  for (const Support& support : part.supports) widest = std::max(widest, reach_of(support));
  return std::min(widest, part.range.reach);
}

double ProjectOperator::find_supports(Part& part) const {
  part.supports.assign(part.own.size(), Support{});
  const double loaded = part.range.reach;
  const double cap = std::min(parameters_.cap, loaded);
  const CellGrid grid(source_lattice_, part.candidates, std::max(loaded, kSmallestReach));
  const std::size_t chunk_count = (part.own.size() + kChunkPoints - 1) / kChunkPoints;
  std::vector<double> needed(chunk_count, 0);
  parallel_for(chunk_count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * kChunkPoints; i < std::min(end * kChunkPoints, part.own.size());
         ++i) {
      const std::optional<double> distance =
          grid.kth_distance(part.own[i], parameters_.nearest, cap);
      if (distance) part.supports[i] = support_at(*distance);
      double& most = needed[i / kChunkPoints];
      if (distance)
        most = std::max({most, *distance, reach_of(part.supports[i])});
      else if (loaded < parameters_.cap)
        most = std::max(most, 2 * loaded);
    }
  });
  return *std::ranges::max_element(needed);
}

}  // namespace pss
