#include "stream/passes/part_needs.h"

#include <algorithm>

#include "core/parallel.h"
#include "stream/passes/ball_bound.h"

namespace pss {
namespace {

/// What is reserved for the points of a ball before they are counted: twelve times as many as lie
/// within reach of a point at h = 2 spacings.
constexpr std::uint64_t kUsualBall = 2048;

/// The points of a ball that a part has room for.
std::uint64_t reserved_ball(const PartPlan& plan) {
  return std::min(plan.ball_points, plan.measured_ball ? plan.measured_ball : kUsualBall);
}

std::uint64_t bytes_for_tasks(const Operator& op, const PartPlan& plan) {
  const std::uint64_t most = plan.own_points / Operator::kTaskPoints + plan.own.size();
  const std::uint64_t tasks = std::min(static_cast<std::uint64_t>(thread_count()), most);
  const bool looks = op.neighbourhood().largest_reach() > 0;
  return tasks * op.scratch_bytes(looks ? reserved_ball(plan) : 0);
}

std::uint64_t bytes_per_candidate(const Operator& op, const PartPlan& plan) {
  if (!op.needs().normals) return sizeof(Index3);
  const std::uint64_t both = sizeof(Index3) + sizeof(Normal);
  // What does not come in key order is sorted by way of an order and a copy.
  return both + (plan.ordered ? 0 : sizeof(std::uint32_t) + sizeof(Index3));
}

}  // namespace

Preparation prepare(const Operator& op, const Lattice& lattice, Part& part) {
  const Neighbourhood& neighbourhood = op.neighbourhood();
  if (part.own.empty() || neighbourhood.largest_reach() <= 0) return {};
  if (!part.grid) part.grid.emplace(lattice, part.candidates, neighbourhood.grid_radius(part));
  if (neighbourhood.find_distances(part)) return {true, 0};
  const std::uint64_t reserved = std::min(part.ball_points, kUsualBall);
  if (!op.gathers_neighbours() || part.ball_points <= reserved) return {};
  const auto reach = [&](std::size_t i) { return neighbourhood.reach_of(part, i); };
  const std::uint64_t counted =
      std::min(part.ball_points, ball_bound(*part.grid, part.own, reach, reserved));
  return {false, counted == reserved ? 0 : counted};
}

std::uint64_t part_bytes(const Operator& op, const PartPlan& plan) {
  const std::uint64_t row = op.needs().row_size;
  const std::uint64_t rows = std::max(plan.own_points, op.most_rows(plan.own_points));
  // The result is compressed when what lies around is gone.
  const std::uint64_t encoded = rows * (row + sizeof(Index3) + row / 64 + 1);
  const std::uint64_t near = plan.near_points * bytes_per_candidate(op, plan) +
                             CellGrid::bytes_for(plan.near_points) +
                             op.neighbourhood().bytes(plan) + bytes_for_tasks(op, plan);
  return rows * (sizeof(Index3) + row) + plan.own_points + std::max(encoded, near);
}

}  // namespace pss
