#include "io/points/common_crs.h"

#include <gtest/gtest.h>

namespace pss::test {
namespace {

CloudHeader header(const std::string& path, const std::string& crs) {
  CloudHeader header;
  header.path = path;
  header.crs = crs;
  return header;
}

TEST(CommonCrs, TakesFilesOfTheSameOneAndFilesWithoutAny) {
  CommonCrs common;
  for (const char* crs : {"", "EPSG:2994", "", "EPSG:2994"})
    EXPECT_TRUE(common.add(header("a.las", crs)).has_value()) << crs;
}

TEST(CommonCrs, OfFilesThatDifferIsRefusedWithBothNames) {
  CommonCrs common;
  EXPECT_TRUE(common.add(header("a.las", "EPSG:2994")).has_value());
  EXPECT_TRUE(common.add(header("b.las", "")).has_value());

  const auto refused = common.add(header("c.las", "EPSG:4326 " + std::string(10000, 'x')));

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::kBadInput);
  for (const char* said : {"a.las", "c.las", "EPSG:2994", "EPSG:4326"})
    EXPECT_NE(refused.error().message.find(said), std::string::npos) << refused.error().message;
  EXPECT_LT(refused.error().message.size(), 500u);
}

}  // namespace
}  // namespace pss::test
