#include <fmt/format.h>

#include <cstdio>

#include "bench/peers/modes.h"

namespace pss::bench {
namespace {

std::vector<Entry> entries_for(const Settings& settings, const Contenders& contenders,
                               double radius, double spacing) {
  std::vector<Entry> entries;
  for (const auto& who : contenders)
    if (takes_part(settings, *who, radius)) entries.push_back({who.get(), radius * spacing});
  return entries;
}

}  // namespace

bool takes_part(const Settings& settings, const Contender& who, double radius) {
  return radius <= settings.cgal_radius || !who.name().starts_with("CGAL");
}

Result<void> for_each_cloud(const Settings& settings,
                            const std::function<void(const Cloud&, double)>& use) {
  for (const double noise : settings.noises) {
    SynthOptions options = settings.cloud;
    options.noise = noise;
    PSS_ASSIGN(const Cloud cloud, make_cloud(options));
    use(cloud, noise);
  }
  return {};
}

const char* order_name(SynthOrder order) {
  return order == SynthOrder::kSweep ? "sweep" : "scattered";
}

Result<void> compare_at_equal_radius(const Settings& settings, const Contenders& contenders,
                                     Report& report) {
  return for_each_cloud(settings, [&](const Cloud& cloud, double noise) {
    for (const int threads : settings.threads)
      for (const double radius : settings.radii) {
        const std::string text = fmt::format(
            "{} points of a {} in {} order, noise {} s, R = {} s, order {}, {} thread{}",
            cloud.points.size(), shape_name(cloud.surface), order_name(settings.cloud.order), noise,
            radius, settings.degree, threads, threads == 1 ? "" : "s");
        fmt::print(stderr, "{}\n", text);
        const auto entries = entries_for(settings, contenders, radius, cloud.spacing);
        report.add({text, cloud.spacing, noise},
                   run_rounds(cloud, entries, {settings.degree, threads, settings.runs}));
      }
  });
}

}  // namespace pss::bench
