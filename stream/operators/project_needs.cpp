// What parts of a projection need: how far they look, and how much memory that takes.

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"
#include "core/support.h"
#include "stream/operators/ball_bound.h"
#include "stream/operators/key_groups.h"
#include "stream/operators/project.h"
#include "stream/store/block.h"

namespace pss {
namespace {

/// What is reserved for the points of a ball before they are counted: twelve times as many as lie
/// within reach of a point at h = 2 spacings.
constexpr std::uint64_t kUsualBall = 2048;
/// Points that are surrounded together where each owns its support.
constexpr std::size_t kGroupPoints = 256;
constexpr std::size_t kGuessStep = 4;  ///< of so many points one is asked for a guess

}  // namespace

Support ProjectOperator::support_at(double distance) const {
  return support_of_radius(parameters_.factor * distance, parameters_.method);
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
  // Half more than the typical query needs.
  return std::min(largest_reach(), 1.5 * usual_reach());
}

std::vector<Surround> ProjectOperator::around(const PartPlan& plan) const {
  std::vector<Surround> around;
  if (largest_reach() <= 0) return around;
  for (const BlockInfo& block : plan.own) around.push_back({block.box, first_reach()});
  return around;
}

std::vector<Surround> ProjectOperator::around(const PartPlan& plan, const Part& part) const {
  if (!parameters_.nearest || largest_reach() <= 0) return around(plan);
  std::vector<Surround> around;
  for (const PointRange& group : key_groups(part.own, kGroupPoints)) {
    const auto own = std::span(part.own).subspan(group.begin, group.end - group.begin);
    around.push_back({box_of(own), 0, group});
  }
  parallel_for(around.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g)
      around[g].reach = parameters_.buffer.value_or(guessed_reach(part.own, around[g].own));
  });
  return around;
}

/// The k positions after a point in key order, or those before it, are no nearer than its k
/// nearest; where the order does not leap away from it, they are not much farther either.
double ProjectOperator::guessed_reach(std::span<const Index3> own, const PointRange& group) const {
  const auto k = static_cast<std::size_t>(parameters_.nearest);
  const double nothing = std::numeric_limits<double>::infinity();
  const auto farthest = [&](std::size_t i, std::size_t first) {
    double most = 0;
    for (std::size_t j = first; j < first + k; ++j)
      most = std::max(most, distance_sq(source_lattice_, own[i], own[j]));
    return most;
  };
  double guess_sq = 0;
  for (std::size_t i = group.begin; i < group.end; i += kGuessStep) {
    const double after = i + k < own.size() ? farthest(i, i + 1) : nothing;
    const double before = i >= k ? farthest(i, i - k) : nothing;
    const double nearer = std::min(before, after);
    if (nearer < nothing) guess_sq = std::max(guess_sq, nearer);
  }
  if (guess_sq == 0) return first_reach();  // too few points to tell, or copies of one
  return std::min(largest_reach(), reach_of(support_at(std::sqrt(guess_sq))));
}

std::uint64_t ProjectOperator::bytes(const PartPlan& plan) const {
  const std::uint64_t row = bytes_per_row();
  const std::uint64_t own = sizeof(Index3) + row + (parameters_.nearest ? sizeof(Support) : 0);
  // The result is compressed when what lies around is gone.
  const std::uint64_t encoded = plan.own_points * (row + sizeof(Index3) + row / 64 + 1);
  const std::uint64_t near = plan.near_points * bytes_per_candidate() +
                             CellGrid::bytes_for(plan.near_points) +
                             plan.around.size() * sizeof(Surround) + bytes_for_tasks(plan);
  return plan.own_points * own + std::max(encoded, near);
}

std::uint64_t ProjectOperator::bytes_for_tasks(const PartPlan& plan) const {
  const std::uint64_t chunks = plan.own_points / kChunkPoints + plan.own.size();
  const std::uint64_t tasks = std::min(static_cast<std::uint64_t>(thread_count()), chunks);
  const std::uint64_t ball = largest_reach() > 0 ? reserved_ball(plan) : 0;
  return tasks *
         (Projector::bytes_for(ball, parameters_.method.op) + QueryBatch::bytes_for(kChunkPoints));
}

std::uint64_t ProjectOperator::reserved_ball(const PartPlan& plan) {
  return std::min(plan.ball_points, plan.measured_ball ? plan.measured_ball : kUsualBall);
}

std::uint64_t ProjectOperator::bytes_per_candidate() const {
  if (!needs_normals(parameters_.method.op)) return sizeof(Index3);
  const std::uint64_t both = sizeof(Index3) + sizeof(Normal);
  // A source that has another order is sorted by way of an order and a copy.
  return both + (source_ordered_ ? 0 : sizeof(std::uint32_t) + sizeof(Index3));
}

Preparation ProjectOperator::prepare(Part& part) const {
  if (part.own.empty() || largest_reach() <= 0) return {};
  if (!part.grid) part.grid.emplace(source_lattice_, part.candidates, grid_radius(part));
  if (parameters_.nearest && find_supports(part)) return {true, 0};
  const std::uint64_t reserved = std::min(part.ball_points, kUsualBall);
  if (part.ball_points <= reserved) return {};
  const auto reach = [&](std::size_t i) {
    const double own = reach_of_own(part, i);
    return own > 0 ? own : -1;  // isolated: no ball
  };
  const std::uint64_t counted =
      std::min(part.ball_points, ball_bound(*part.grid, part.own, reach, reserved));
  return {false, counted == reserved ? 0 : counted};
}

/// What cells should suit: the usual ball here.
double ProjectOperator::grid_radius(const Part& part) const {
  if (!parameters_.nearest || part.around.empty()) return std::max(usual_reach(), kSmallestReach);
  std::vector<double> reaches;
  for (const Surround& group : part.around) reaches.push_back(group.reach);
  const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::ranges::nth_element(reaches, middle);
  // Groups are surrounded about twice as far as their points look.
  return std::max(*middle / 2, kSmallestReach);
}

double ProjectOperator::reach_of_own(const Part& part, std::size_t i) const {
  return parameters_.nearest ? reach_of(part.supports[i]) : largest_reach();
}

bool ProjectOperator::find_supports(Part& part) const {
  part.supports.resize(part.own.size());
  parallel_for(part.around.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g)
      if (!part.around[g].certain) find_supports(part, part.around[g]);
  });
  return !std::ranges::all_of(part.around, &Surround::certain);
}

/// Nothing within the group's reach is missing, so k positions found there are the k nearest.
void ProjectOperator::find_supports(Part& part, Surround& group) const {
  const double loaded = group.reach;
  const double widest = parameters_.buffer.value_or(largest_reach());
  double needed = 0;
  std::optional<double> last;  // of the position before, which is often the same
  for (std::size_t i = group.own.begin; i < group.own.end; ++i) {
    if (i == group.own.begin || part.own[i] != part.own[i - 1])
      last = part.grid->kth_distance(part.own[i], parameters_.nearest,
                                     std::min(parameters_.cap, loaded));
    part.supports[i] = last ? support_at(*last) : Support{};
    if (last)
      needed = std::max({needed, *last, reach_of(part.supports[i])});
    else if (loaded < parameters_.cap)
      needed = std::max(needed, loaded > 0 ? 2 * loaded : widest);
  }
  needed = std::min(needed, widest);
  group.certain = needed <= loaded;
  if (!group.certain) group.reach = needed;
}

}  // namespace pss
