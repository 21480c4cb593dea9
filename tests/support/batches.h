#pragma once
// Projects the same queries in other company: batches, orders, clouds that hold only the reach.

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <numeric>
#include <vector>

#include "tests/support/scan.h"

namespace pss::test {

inline bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

inline bool same_bits(const World3& a, const World3& b) {
  return same_bits(a[0], b[0]) && same_bits(a[1], b[1]) && same_bits(a[2], b[2]);
}

inline bool same_bits(const Projection& a, const Projection& b) {
  return a.status == b.status && a.second_sheet == b.second_sheet && a.redone == b.redone &&
         a.neighbours == b.neighbours && same_bits(a.displacement, b.displacement) &&
         same_bits(a.normal, b.normal) && same_bits(a.mean_curvature, b.mean_curvature) &&
         same_bits(a.gaussian_curvature, b.gaussian_curvature) &&
         same_bits(a.principal_direction, b.principal_direction) &&
         same_bits(a.residual, b.residual) && same_bits(a.boundary, b.boundary);
}

/// Results that differ in a bit.
inline std::size_t count_different(const std::vector<Projection>& a,
                                   const std::vector<Projection>& b) {
  std::size_t count = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) count += !same_bits(a[i], b[i]);
  return count;
}

/// The queries in batches of a size, by one projector.
inline std::vector<Projection> in_batches(const Scan& scan, const Support& support,
                                          const Method& method, std::span<const Query> queries,
                                          std::size_t size) {
  ScanProjector project(scan, support, method);
  std::vector<Projection> results;
  for (std::size_t i = 0; i < queries.size(); i += size)
    std::ranges::copy(project(queries.subspan(i, std::min(size, queries.size() - i))),
                      std::back_inserter(results));
  return results;
}

/// The queries in a seeded random order; the results in theirs.
inline std::vector<Projection> shuffled(const Scan& scan, const Support& support,
                                        const Method& method, std::span<const Query> queries,
                                        std::uint64_t seed) {
  std::vector<std::size_t> order(queries.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed);
  for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.next() % i]);
  std::vector<Query> mixed;
  for (const std::size_t i : order) mixed.push_back(queries[i]);
  ScanProjector project(scan, support, method);
  const std::vector<Projection> given = project(mixed);
  std::vector<Projection> results(queries.size());
  for (std::size_t i = 0; i < order.size(); ++i) results[order[i]] = given[i];
  return results;
}

/// The points of a scan within the reach of a query: all that its result may depend on.
inline Scan within_reach(const Scan& scan, const Query& query, double radius) {
  Scan part{scan.lattice, {}, scan.spacing, {}, scan.oriented};
  for_each_within(scan, query, radius, [&](std::size_t i, const World3&) {
    part.points.push_back(scan.points[i]);
    part.normals.push_back(scan.normals[i]);
  });
  return part;
}

/// Each query alone, in a cloud of the points within its reach.
inline std::vector<Projection> in_own_clouds(const Scan& scan, const Support& support,
                                             const Method& method, std::span<const Query> queries) {
  std::vector<Projection> results;
  for (const Query& query : queries) {
    const Scan part = within_reach(scan, query, reach(method.weight, support));
    results.push_back(ScanProjector(part, support, method)(query));
  }
  return results;
}

/// Expects the same bits in all company; gives the results.
inline std::vector<Projection> expect_same_in_all_company(const Scan& scan, const Support& support,
                                                          const Method& method,
                                                          std::span<const Query> queries) {
  const std::vector<Projection> all = in_batches(scan, support, method, queries, 1000000);
  for (const std::size_t size : {1u, 2u, 3u, 7u, 16u, 64u, 1000u}) {
    if (size >= queries.size()) break;
    EXPECT_EQ(count_different(all, in_batches(scan, support, method, queries, size)), 0u) << size;
  }
  EXPECT_EQ(count_different(all, shuffled(scan, support, method, queries, 5)), 0u);
  EXPECT_EQ(count_different(all, in_own_clouds(scan, support, method, queries)), 0u);
  return all;
}

}  // namespace pss::test
