// Well-known text of coordinate systems.

#include "io/points/wkt.h"

#include <fmt/format.h>

#include "tests/fuzz/allocations.h"
#include "tests/fuzz/target.h"

namespace pss::test {

std::vector<Bytes> seeds() {
  std::vector<Bytes> all = real_files(".prj");
  for (const std::string_view text :
       {R"(COMPD_CS["c",PROJCS["p",GEOGCS["g"],AUTHORITY["EPSG","26910"]],VERT_CS["v"]])",
        R"(PROJCRS["p", BASEGEOGCRS["g", ID["EPSG",4258]], UNIT["m",1]])",
        R"(PROJCS("p",GEOGCS("g",DATUM("NAD83",SPHEROID("GRS 1980",6378137,298.25))),)"
        R"(PROJECTION("Lambert_Conformal_Conic_2SP"),PARAMETER("central_meridian",-120.5)))"})
    all.push_back(bytes_of(text));
  return all;
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const pss::test::AllocationBound bound((1u << 16) + 256 * size);
  const std::string comparable = pss::comparable_wkt(text);
  pss::test::require(comparable == pss::comparable_wkt(fmt::format(" {}\n", text)),
                     "blanks around a text change it");
  return 0;
}
