#pragma once
// The four questions that bench_peers answers.

#include <functional>
#include <string>
#include <vector>

#include "bench/peers/contender.h"
#include "bench/peers/report.h"
#include "io/synth/synth_options.h"

namespace pss::bench {

struct Settings {
  SynthOptions cloud;
  std::vector<double> noises{0.1};     ///< in spacings
  std::vector<double> radii{3.09, 6};  ///< in spacings: about 30 and 113 neighbours
  std::vector<int> threads;            ///< a table each
  double cgal_radius = 4;              ///< in spacings; beyond it CGAL, the slowest, sits out
  double largest_radius = 12;          ///< in spacings, where the radius is free
  int degree = 3;
  int runs = 5;
};

/// How fast is each with the same cloud, radius and degree, and how near to the true surface?
Result<void> compare_at_equal_radius(const Settings& settings, const Contenders& contenders,
                                     Report& report);

/// How fast is each where it is as near to the true surface as the first at the last radius, and
/// how near does it come at all?
Result<void> compare_at_equal_error(const Settings& settings, const Contenders& contenders,
                                    Report& report);

/// Are n threads as fast as n processes side by side, each with its share of the points? Of the
/// contenders that are pss.
///
/// Requires: no thread was started yet: processes are forked.
Result<void> compare_with_processes(const Settings& settings, const Contenders& contenders,
                                    Report& report);

/// How far are pss and its peers from the references of what they compute, on real scans?
///
/// Errors: those of reading the scans.
Result<void> compare_with_reference(const Settings& settings,
                                    const std::vector<std::string>& scans);

/// Calls use(cloud, noise) for a cloud of each noise that is wanted.
Result<void> for_each_cloud(const Settings& settings,
                            const std::function<void(const Cloud&, double)>& use);

/// Whether a contender is fast enough to run with so many spacings of radius.
bool takes_part(const Settings& settings, const Contender& who, double radius);

/// "sweep" or "scattered".
const char* order_name(SynthOrder order);

}  // namespace pss::bench
