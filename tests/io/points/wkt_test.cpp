#include "io/points/wkt.h"

#include <gtest/gtest.h>

#include <string>

namespace pss::test {
namespace {

TEST(Wkt, GivesTheHorizontalCode) {
  EXPECT_EQ(comparable_wkt(R"(PROJCS["a [b]",GEOGCS["g",AUTHORITY["EPSG","4269"]],UNIT["m",1,)"
                           R"(AUTHORITY["EPSG","9001"]],AUTHORITY["EPSG","2994"]])"),
            "EPSG:2994");
  EXPECT_EQ(comparable_wkt(R"(COMPD_CS["c",PROJCS["p",GEOGCS["g"],AUTHORITY["EPSG","26910"]],)"
                           R"(VERT_CS["v",AUTHORITY["EPSG","5703"]]])"),
            "EPSG:26910");
  EXPECT_EQ(comparable_wkt(R"(PROJCRS["p", BASEGEOGCRS["g", ID["EPSG",4258]], ID["EPSG",25832]])"),
            "EPSG:25832");
  EXPECT_EQ(comparable_wkt(R"(GEOGCS["g",AUTHORITY["EPSG","4326"]])"), "EPSG:4326");
}

std::string lambert(const char* name, const char* datum, const char* axis, const char* meridian) {
  return std::string("PROJCS[\"") + name + "\",GEOGCS[\"g\",DATUM[\"" + datum +
         "\",SPHEROID[\"GRS 1980\"," + axis +
         ",298.2572221]]],PROJECTION[\"Lambert_Conformal_Conic_2SP\"],PARAMETER[\"central_"
         "meridian\"" +
         "," + meridian + "],UNIT[\"foot\",0.3048]]";
}

TEST(Wkt, WithoutACodeComparesWhatDefinesTheSystem) {
  const std::string one = comparable_wkt(lambert("one", "NAD83 HARN", "6378137", "-120.5"));

  EXPECT_EQ(one, comparable_wkt(lambert("other", "NAD83_HARN", "6378137.0", "-120.50000000001")));
  EXPECT_NE(one, comparable_wkt(lambert("one", "NAD83 HARN", "6378137", "-120")));
  EXPECT_NE(one, comparable_wkt(lambert("one", "NAD83", "6378137", "-120.5")));
  EXPECT_NE(one, comparable_wkt(lambert("one", "NAD83 HARN", "6378160", "-120.5")));
}

TEST(Wkt, DamagedTextIsNone) {
  const std::string whole = R"(PROJCS["p",GEOGCS["g",UNIT["m",1]],UNIT["m",1]])";
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_EQ(comparable_wkt(whole.substr(0, length)), "") << length;
  EXPECT_EQ(comparable_wkt(R"(A[,])"), "");
  EXPECT_EQ(comparable_wkt(R"([])"), "");
}

TEST(Wkt, NestingIsBounded) {
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "A[";

  EXPECT_EQ(comparable_wkt(deep), "");
}

}  // namespace
}  // namespace pss::test
