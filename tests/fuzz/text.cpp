// Text files of points: separators, names, counts, comments.

#include "io/formats/text/text_reader.h"
#include "tests/fuzz/read_points.h"
#include "tests/fuzz/target.h"

namespace pss::test {

std::vector<Bytes> seeds() {
  std::vector<Bytes> all = real_files(".pts");
  for (const std::string_view text :
       {"1 2 3\n4.5 -5e-3 +6\n", "\xef\xbb\xbfx,y,z,a,a,\n1,2,3,4,5\n", "2\n1 2 3 9\n4 5 6 8\n",
        "# a\n// X Y Z Red Green Blue\r\n1 2 3 0 255 1\r\n\r\n#b\r\n4 5 6 1 2 3\r\n",
        "Easting [m];Northing;Elevation;\"a b\"\n1;2;nan;inf\n",
        "1\t2\t3\t4\t5\t6\t7\r1\t2\t3 \t4\t5\t6\t7"})
    all.push_back(bytes_of(text));
  return all;
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pss::test::read_points(data, size, pss::open_text);
  return 0;
}
