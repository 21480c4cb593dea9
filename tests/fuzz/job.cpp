// The JSON that a job keeps: its record, and the summary of its result.

#include "stream/jobs/job.h"

#include "stream/jobs/run_job.h"
#include "stream/jobs/smooth_kind.h"
#include "tests/fuzz/allocations.h"
#include "tests/fuzz/target.h"

namespace pss::test {

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (const std::string_view text :
       {R"({"program":"pss","version":2,"command":"smooth","output":"/b%FF.las",)"
        R"("sorting":{"tile-points":9},"parameters":{"h":1,"radius":null},)"
        R"("inputs":[{"path":"/a.las","size":1,"modified_ns":2,"content_hash":3}],)"
        R"("passes":["normals","smooth"],"may_grow":false,)"
        R"("spoiled":"","discarding":false,"complete":true,"result":{"size":1,"modified_ns":2,)"
        R"("hash":"00112233445566778899aabbccddeeff"},"checksum":"0000000000000000"})",
        R"({"ingest":{"points_read":5,"points_stored":5,"largest_move":0.5},"normals":"computed",)"
        R"("widths":{"radius":1.5,"h":0.5,"knn":3,"radius_per_distance":1,"cap":0,"typical":1,)"
        R"("neighbours":9,"why":"a","spacing":{"spacing":1,"d16_median":2,"d16_p10":1,)"
        R"("d16_p90":3,"sample":9},"noise":{"sigma":0.1,"other_sheet":2,"sample":4,"first":0,)"
        R"("trials":[{"h":1,"known":true,"usable":1,"residual":2}],"h_per_spacing":2,)"
        R"("limit":"noise","expected":1}},"notes":["a"],"store_bytes":7})"})
    all.push_back(bytes_of(text));
  return all;
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pss;
  const test::OneFile file("/job.json", std::as_bytes(std::span(data, size)));
  const test::AllocationBound bound((1u << 20) + 512 * size);
  const auto record = read_job_record("");
  if (record && *record) {
    test::require(difference(**record, **record).empty(), "not the same job as itself");
    static_cast<void>(identity_of(**record));
    for (const std::string& pass : (*record)->passes)
      test::require(is_pass_name(pass), "a pass that leads elsewhere");
    test::require(!all_parameters(**record).empty(), "no parameters");
  }
  const SmoothJob job;
  SmoothKind kind(job);
  JobReport report;
  read_result_summary({reinterpret_cast<const char*>(data), size}, report, kind);
  return 0;
}
