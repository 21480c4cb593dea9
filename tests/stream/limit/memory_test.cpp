#include "stream/limit/memory.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "stream/limit/cgroup.h"
#include "tests/support/test_data.h"

namespace pss::test {
namespace {

constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();

void write(const std::string& path, const std::string& text) {
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path) << text << '\n';
}

TEST(CgroupMemoryLimit, IsTheLeastOfAGroupAndThoseAboveIt) {
  TemporaryDirectory root;
  write(root / "memory/memory.limit_in_bytes", "9000");
  write(root / "memory/job/memory.limit_in_bytes", "700");
  write(root / "memory/job/inner/memory.limit_in_bytes", "8000");
  const std::string first = root / "";
  EXPECT_EQ(cgroup_memory_limit("4:cpu:/job\n3:memory:/job/inner\n", first), 700u);
  EXPECT_EQ(cgroup_memory_limit("3:cpu,memory:/\n", first), 9000u);
  EXPECT_EQ(cgroup_memory_limit("3:memory:/unseen/from/here\n", first), 9000u);
}

TEST(CgroupMemoryLimit, KnowsBothVersionsAndThatThereMayBeNone) {
  TemporaryDirectory root;
  write(root / "a/memory.max", "max");
  write(root / "a/b/memory.max", "5000");
  const std::string first = root / "";
  EXPECT_EQ(cgroup_memory_limit("0::/a/b\n", first), 5000u);
  EXPECT_EQ(cgroup_memory_limit("0::/a\n", first), kNone);
  EXPECT_EQ(cgroup_memory_limit("", first), kNone);
  EXPECT_EQ(cgroup_memory_limit("no colons\n:\n", first), kNone);
}

TEST(MemoryBudget, GrowsAReservationAsAWholeOrNotAtAll) {
  MemoryBudget budget(512u << 20, 1);
  Reservation held;
  EXPECT_TRUE(budget.grow(held, 1000));
  EXPECT_TRUE(budget.grow(held, 400));
  EXPECT_EQ(held.bytes(), 1000u);
  EXPECT_FALSE(budget.grow(held, budget.total() + 1));
  EXPECT_EQ(held.bytes(), 1000u);
  EXPECT_TRUE(budget.grow(held, budget.total()));
  EXPECT_EQ(budget.available(), 0u);
  held.release();
  EXPECT_EQ(budget.available(), budget.total());
}

}  // namespace
}  // namespace pss::test
