#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/simd/targets.h"
#include "tests/support/batches.h"
#include "tests/support/methods.h"
#include "tests/support/scan.h"

namespace pss::test {
namespace {

constexpr double kSpacing = 0.06;

/// A noisy torus among points of no surface, whose neighbourhoods try every safeguard; a normal is
/// missing here and there.
Scan cluttered_torus() {
  const Torus torus{1, 0.4};
  Random random(21);
  std::vector<SurfacePoint> samples;
  const Scan clean = scan_of(torus, kSpacing, 0.3 * kSpacing);
  for (const Index3& p : clean.points) {
    const World3 at = to_world(clean.lattice, p);
    samples.push_back({at, foot_of(torus, at).normal});
  }
  for (int i = 0; i < 1500; ++i) {
    const World3 at{random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5),
                    random.uniform(-0.6, 0.6)};
    samples.push_back({at, normalized({random.uniform(-1, 1), random.uniform(-1, 1), 0.1})});
  }
  for (std::size_t i = 5; i < samples.size(); i += 61) samples[i].normal = {0, 0, 0};
  Scan scan = sorted_scan(clean.lattice, samples);
  scan.spacing = kSpacing;
  return scan;
}

std::vector<Query> queries_of(const Scan& scan, std::size_t count) {
  std::vector<Query> queries = some_queries(scan, count);
  Random random(4);
  for (std::size_t i = 0; i < queries.size(); i += 2)  // on the lattice, and between
    for (double& c : queries[i].remainder) c = 0.3 * kSpacing * random.uniform(-1, 1);
  return queries;
}

class Company : public testing::TestWithParam<Method> {};
INSTANTIATE_TEST_SUITE_P(Each, Company, testing::ValuesIn(all_methods({3})), method_name);

TEST_P(Company, OfOtherQueriesAndPointsBeyondTheReachChangesNoBit) {
  Scan scan = cluttered_torus();
  const Support support{2 * kSpacing, 6 * kSpacing};
  const std::vector<Query> queries = queries_of(scan, 120);
  expect_same_in_all_company(scan, support, GetParam(), queries);
  if (!needs_normals(GetParam().op)) return;
  scan.oriented = false;
  expect_same_in_all_company(scan, support, GetParam(), queries);
}

TEST_P(Company, OfMoreOrFewerLanesChangesNoBit) {
  Scan scan = cluttered_torus();
  const Support support{2 * kSpacing, 6 * kSpacing};
  const std::vector<Query> queries = queries_of(scan, 60);
  for (const bool oriented : {true, false}) {
    scan.oriented = oriented;
    const std::vector<Projection> widest = ScanProjector(scan, support, GetParam())(queries);
    for (const simd::Target& target : simd::targets()) {
      const simd::ForcedTarget forced(target);
      EXPECT_EQ(count_different(ScanProjector(scan, support, GetParam())(queries), widest), 0u)
          << target.name;
    }
  }
}

TEST_P(Company, OfQueriesThatLookFartherChangesNoBit) {
  const Scan scan = cluttered_torus();
  const Support widest{3 * kSpacing, 9 * kSpacing};
  const std::vector<Query> queries = queries_of(scan, 120);
  std::vector<Support> supports;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const double h = (1 + 0.5 * static_cast<double>(i % 5)) * kSpacing;
    supports.push_back({h, (2 + 0.25 * static_cast<double>(i % 3)) * h});
  }
  const std::vector<Projection> together =
      ScanProjector(scan, widest, GetParam())(queries, supports);
  std::vector<Projection> alone;
  for (std::size_t i = 0; i < queries.size(); ++i)
    alone.push_back(ScanProjector(scan, supports[i], GetParam())(queries[i]));
  EXPECT_EQ(count_different(together, alone), 0u);
}

}  // namespace
}  // namespace pss::test
