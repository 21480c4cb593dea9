#pragma once
// Operators run over sources, within limits of memory.

#include <string>

#include "stream/passes/scheduler.h"
#include "tests/stream/store_fixture.h"

namespace pss::test {

inline constexpr std::uint64_t kMiB = 1u << 20;

/// The limit that leaves `bytes` for parts.
inline std::uint64_t limit_leaving(std::uint64_t bytes) {
  return bytes + 512 * kMiB - MemoryBudget(512 * kMiB, 1).total();
}

/// The finished result of an operator.
inline Store run(const PassSources& sources, const Operator& op, const std::string& path,
                 std::uint64_t limit = 512 * kMiB) {
  MemoryBudget budget(limit, 1);
  Monitor monitor;
  StoreWriter writer = expect_value(StoreWriter::create(path, op.result_header()));
  const auto summary = expect_value(run_operator(sources, op, writer, budget, monitor));
  if (!sources.tiles) {
    EXPECT_EQ(summary.own_points, sources.queries.points());
  }
  expect_ok(writer.finish("{}"));
  return expect_value(Store::open(path));
}

}  // namespace pss::test
