#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "bench/peers/modes.h"

namespace pss::bench {
namespace {

constexpr double kSmallestRadius = 2.5;  // in spacings: 20 neighbours, twice what order 3 needs
constexpr double kRadiusStep = 1.15;

/// One cloud, on which every contender may choose its radius.
class FreeRadius {
 public:
  FreeRadius(const Settings& settings, const Cloud& cloud) : settings_(settings), cloud_(cloud) {}

  Row run_one(const Contender& who, double radius) const {
    const Entry entry{&who, radius * cloud_.spacing};
    return run_rounds(cloud_, std::span(&entry, 1), {settings_.degree, 1, 1}).front();
  }

  /// One run each at radii from small to large.
  std::vector<Row> sweep(const Contender& who) const {
    std::vector<Row> rows;
    for (double radius = kSmallestRadius; radius <= settings_.largest_radius; radius *= kRadiusStep)
      if (takes_part(settings_, who, radius)) rows.push_back(run_one(who, radius));
    return rows;
  }

 private:
  const Settings& settings_;
  const Cloud& cloud_;
};

double rms(const Row& row) { return row.errors.rms; }

/// Where the error falls to `level` for the first time, between two radii as a power law.
std::optional<double> radius_reaching(double level, const std::vector<Row>& sweep) {
  const auto at = std::ranges::find_if(sweep, [&](const Row& row) { return rms(row) <= level; });
  if (at == sweep.end()) return std::nullopt;
  if (at == sweep.begin()) return at->entry.radius;
  const Row& before = *(at - 1);
  const double part = std::log(rms(before) / level) / std::log(rms(before) / rms(*at));
  return before.entry.radius * std::pow(at->entry.radius / before.entry.radius, part);
}

void compare_on(const Settings& settings, const Contenders& contenders, double noise,
                const Cloud& cloud, Report& report) {
  const FreeRadius free(settings, cloud);
  const Contender& first = *contenders.front();
  const double level = rms(free.run_one(first, settings.radii.back()));
  std::vector<Entry> reaching;
  std::vector<Row> best;
  for (const auto& who : contenders) {
    const std::vector<Row> sweep = free.sweep(*who);
    if (sweep.empty()) continue;
    best.push_back(*std::ranges::min_element(sweep, {}, rms));
    if (const auto radius = radius_reaching(level, sweep)) reaching.push_back({who.get(), *radius});
  }
  const std::string where =
      fmt::format("{} points of a {} in {} order, noise {} s, order {}, 1 thread, radius free",
                  cloud.points.size(), shape_name(cloud.surface), order_name(settings.cloud.order),
                  noise, settings.degree);
  report.add(
      {fmt::format("{}: as near as {} at R = {} s", where, first.name(), settings.radii.back()),
       cloud.spacing, noise},
      run_rounds(cloud, reaching, {settings.degree, 1, settings.runs}));
  report.add(
      {fmt::format("{}: nearest of all R <= {} s, one run each", where, settings.largest_radius),
       cloud.spacing, noise},
      best);
}

}  // namespace

Result<void> compare_at_equal_error(const Settings& settings, const Contenders& contenders,
                                    Report& report) {
  return for_each_cloud(settings, [&](const Cloud& cloud, double noise) {
    compare_on(settings, contenders, noise, cloud, report);
  });
}

}  // namespace pss::bench
