// PLY files: header, text and bytes of both orders, lists, other elements.

#include "io/formats/ply/ply_reader.h"
#include "tests/fuzz/read_points.h"
#include "tests/fuzz/target.h"

namespace pss::test {
namespace {

/// Two faces, then two points with a colour and a list.
std::string head(std::string_view encoding) {
  return "ply\nformat " + std::string(encoding) +
         " 1.0\ncomment a\nelement face 2\nproperty list uchar int vertex_indices\n"
         "element vertex 2\nproperty float x\nproperty double y\nproperty short z\n"
         "property uchar red\nproperty list ushort float more\nend_header\n";
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> all = real_files(".ply");
  all.push_back(bytes_of(head("ascii") + "2 0 1\n0\n1 2.5 -3 255 1 7e-3\n\nnan inf 4 0 0\n"));
  const std::string little(
      "\1\0\0\0\0\0\0\0\0\200?\0\0\0\0\0\0\4@\3\0\1\0\0\0\0\0@"
      "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\5\0\2\0\0",
      45);
  all.push_back(bytes_of(head("binary_little_endian") + little));
  all.push_back(bytes_of(head("binary_big_endian") + std::string(64, '\0')));
  all.push_back(
      bytes_of("ply\rformat ascii 1.0\relement vertex 1\rproperty char x\r"
               "property uint y\rproperty int z\rend_header\r1 2 3\r"));
  return all;
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  pss::test::read_points(data, size, pss::open_ply);
  return 0;
}
