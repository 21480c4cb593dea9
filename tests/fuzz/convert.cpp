// Any file of points to any format: what is odd in a header and goes on into another file.

#include "io/convert.h"

#include "io/open.h"
#include "tests/fuzz/allocations.h"
#include "tests/fuzz/target.h"
#include "tests/io/formats/las/las_bytes.h"

namespace pss::test {
namespace {

constexpr const char* kOutputs[] = {"/out.las", "/out.ply", "/out.xyz", "/out.csv", "/out.pts"};

Bytes chosen(std::size_t output, std::string_view content) {
  Bytes bytes = bytes_of(content);
  bytes.insert(bytes.begin(), static_cast<std::byte>(output));
  return bytes;
}

Result<std::uint64_t> points_in(const std::string& path) {
  PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_reader(path));
  std::uint64_t points = 0;
  for (PointBatch batch;; points += batch.size()) {
    PSS_TRY(reader->read(1000, batch));
    if (batch.size() == 0) return points;
  }
}

void convert_and_read(const std::string& input, const std::string& output) {
  Monitor monitor;
  const auto summary = convert({input}, output, {}, monitor);
  if (!summary || summary->points_out == 0) return;
  const auto points = points_in(output);
  require(points.has_value(),
          "wrote what cannot be read: " + (points ? "" : points.error().message));
  require(*points == summary->points_out, "another number of points");
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (std::size_t output = 0; output < std::size(kOutputs); ++output) {
    all.push_back(chosen(output, las({.format = 3})));
    all.push_back(chosen(
        output, las({.minor = 4,
                     .format = 10,
                     .extra = 12,
                     .vlrs = vlr("LASF_Spec", 4,
                                 descriptor(4, "depth", 24, 0.01, 5) + descriptor(0, "raw", 3)),
                     .vlr_count = 1,
                     .evlrs = evlr("copc", 1, "c"),
                     .evlr_count = 1})));
    all.push_back(chosen(output, "# a\nx,y,z,Red,a\n1,2,3,4,5\n1e9,2,nan,4,5\n"));
    all.push_back(chosen(output,
                         "ply\nformat ascii 1.0\nelement vertex 2\nproperty int x\n"
                         "property double y\nproperty float z\nproperty uchar red\n"
                         "property float nx\nend_header\n1 2.5 -3 255 1\n1 2 3 4 5\n"));
  }
  return all;
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const auto content = std::as_bytes(std::span(data, size)).subspan(1);
  const pss::test::OneFile file("/in", content);
  // A record's 65535 undescribed bytes become as many columns, each with its name.
  const pss::test::AllocationBound bound((256u << 20) + 1024 * size);
  pss::test::convert_and_read(file.path(), pss::test::kOutputs[data[0] % 5]);
  return 0;
}
