// LAS files: header, VLRs, extra bytes, coordinate system, records, EVLRs.

#include "io/formats/las/las_reader.h"
#include "tests/fuzz/read_points.h"
#include "tests/fuzz/target.h"
#include "tests/io/formats/las/las_bytes.h"

namespace pss::test {

std::vector<Bytes> seeds() {
  std::vector<Bytes> all = real_files(".las");
  for (int format = 0; format <= 10; ++format)
    all.push_back(bytes_of(las({.minor = format < 6 ? 2 : 4, .format = format})));
  const std::string extra =
      descriptor(4, "depth", 24, 0.01, 5) + descriptor(0, "raw", 3) + descriptor(13, "pair");
  const std::string keys("\1\0\1\0\0\0\1\0\0\14\0\0\1\0\352\32", 16);
  const std::string wkt = R"(PROJCS["p",GEOGCS["g",AUTHORITY["EPSG","4269"]],UNIT["m",1]])";
  all.push_back(bytes_of(las(
      {.minor = 4,
       .format = 7,
       .extra = 12,
       .vlrs = vlr("LASF_Spec", 4, extra) + vlr("LASF_Projection", 34735, keys) + vlr("a", 1, "b"),
       .vlr_count = 3,
       .evlrs = evlr("LASF_Projection", 2112, wkt) + evlr("copc", 1, "c"),
       .evlr_count = 2})));
  return all;
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pss::test::read_points(data, size, pss::open_las);
  return 0;
}
