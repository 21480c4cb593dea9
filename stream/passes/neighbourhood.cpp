#include "stream/passes/neighbourhood.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "stream/passes/key_groups.h"

namespace pss {
namespace {

/// Points that are surrounded together where each has its own k nearest.
constexpr std::size_t kGroupPoints = 256;
constexpr std::size_t kGuessStep = 4;  ///< of so many points one is asked for a guess
/// A grid wants some width, also where no point looks around.
constexpr double kSmallestReach = std::numeric_limits<double>::min();
constexpr double kNone = -1;  ///< the distance of a k-th nearest that there is not

}  // namespace

Neighbourhood Neighbourhood::fixed(double reach) {
  Neighbourhood neighbourhood;
  neighbourhood.fixed_ = reach;
  return neighbourhood;
}

Neighbourhood Neighbourhood::nearest(NearestRule rule) {
  Neighbourhood neighbourhood;
  neighbourhood.nearest_ = std::move(rule);
  return neighbourhood;
}

Neighbourhood Neighbourhood::narrowed(double width) const {
  Neighbourhood neighbourhood = *this;
  neighbourhood.width_ = width;
  return neighbourhood;
}

double Neighbourhood::reach_at(double distance) const {
  return nearest_.reach_at ? nearest_.reach_at(distance) : distance;
}

double Neighbourhood::largest_reach() const {
  if (!is_nearest()) return fixed_;
  return std::max(nearest_.cap, reach_at(nearest_.cap));
}

double Neighbourhood::usual_reach() const {
  return is_nearest() ? reach_at(nearest_.first_guess) : largest_reach();
}

/// How far to load around the part's blocks, where each point has its own k nearest: a guess.
double Neighbourhood::first_reach() const {
  if (width_) return *width_;
  if (!is_nearest()) return largest_reach();
  // Half more than the typical query needs.
  return std::min(largest_reach(), 1.5 * usual_reach());
}

double Neighbourhood::reach_of(const Part& part, std::size_t i) const {
  if (!is_nearest()) return largest_reach();
  const double distance = part.kth_distances[i];
  return distance < 0 ? kNone : reach_at(distance);
}

std::vector<Surround> Neighbourhood::around(const PartPlan& plan) const {
  std::vector<Surround> around;
  if (largest_reach() <= 0) return around;
  for (const BlockInfo& block : plan.own) around.push_back({block.box, first_reach()});
  return around;
}

std::vector<Surround> Neighbourhood::around(const PartPlan& plan, const Part& part) const {
  if (!is_nearest() || largest_reach() <= 0) return around(plan);
  std::vector<Surround> around;
  for (const PointRange& group : key_groups(part.own, kGroupPoints)) {
    const auto own = std::span(part.own).subspan(group.begin, group.end - group.begin);
    around.push_back({box_of(own), 0, group});
  }
  parallel_for(around.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g)
      around[g].reach = width_ ? *width_ : guessed_reach(plan.lattice, part.own, around[g].own);
  });
  return around;
}

/// A reach that holds what most points of a group need, from their neighbours in key order.
///
/// The k positions after a point in key order, or those before it, are no nearer than its k
/// nearest; where the order does not leap away from it, they are not much farther either.
double Neighbourhood::guessed_reach(const Lattice& lattice, std::span<const Index3> own,
                                    const PointRange& group) const {
  const auto k = static_cast<std::size_t>(nearest_.k);
  const double nothing = std::numeric_limits<double>::infinity();
  const auto farthest = [&](std::size_t i, std::size_t first) {
    double most = 0;
    for (std::size_t j = first; j < first + k; ++j)
      most = std::max(most, distance_sq(lattice, own[i], own[j]));
    return most;
  };
  double guess_sq = 0;
  for (std::size_t i = group.begin; i < group.end; i += kGuessStep) {
    const double after = i + k < own.size() ? farthest(i, i + 1) : nothing;
    const double before = i >= k ? farthest(i, i - k) : nothing;
    const double nearer = std::min(before, after);
    if (nearer < nothing) guess_sq = std::max(guess_sq, nearer);
  }
  if (guess_sq == 0) return first_reach();  // too few points to tell, or duplicates of one
  return std::min(largest_reach(), reach_at(std::sqrt(guess_sq)));
}

double Neighbourhood::grid_radius(const Part& part) const {
  if (!is_nearest() || part.around.empty()) return std::max(usual_reach(), kSmallestReach);
  std::vector<double> reaches;
  for (const Surround& group : part.around) reaches.push_back(group.reach);
  const auto middle = reaches.begin() + static_cast<std::ptrdiff_t>(reaches.size() / 2);
  std::ranges::nth_element(reaches, middle);
  // Groups are surrounded about twice as far as their points look.
  const double half = std::min(*middle / 2, usual_reach() > 0 ? usual_reach() : *middle);
  return std::max(half, kSmallestReach);
}

bool Neighbourhood::find_distances(Part& part) const {
  if (!is_nearest()) return false;
  part.kth_distances.resize(part.own.size());
  parallel_for(part.around.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g)
      if (!part.around[g].certain) find_distances(part, part.around[g]);
  });
  return !std::ranges::all_of(part.around, &Surround::certain);
}

std::optional<double> Neighbourhood::kth_distance(const CellGrid& grid, const Index3& position,
                                                  double cap) const {
  return nearest_.each_point ? grid.kth_point_distance(position, nearest_.k, cap)
                             : grid.kth_distance(position, nearest_.k, cap);
}

/// Nothing within the group's reach is missing, so k positions found there are the k nearest.
void Neighbourhood::find_distances(Part& part, Surround& group) const {
  const double loaded = group.reach;
  const double widest = width_.value_or(largest_reach());
  double needed = 0;
  std::optional<double> last;  // of the position before, which is often the same
  for (std::size_t i = group.own.begin; i < group.own.end; ++i) {
    if (i == group.own.begin || part.own[i] != part.own[i - 1])
      last = kth_distance(*part.grid, part.own[i], std::min(nearest_.cap, loaded));
    part.kth_distances[i] = last.value_or(kNone);
    if (last)
      needed = std::max({needed, *last, reach_at(*last)});
    else if (loaded < nearest_.cap)
      needed = std::max(needed, loaded > 0 ? 2 * loaded : widest);
  }
  needed = std::min(needed, widest);
  group.certain = needed <= loaded;
  if (!group.certain) group.reach = needed;
}

std::uint64_t Neighbourhood::bytes(const PartPlan& plan) const {
  const std::uint64_t distances = is_nearest() ? plan.own_points * sizeof(double) : 0;
  return distances + plan.around.size() * sizeof(Surround);
}

}  // namespace pss
