// The log of a killed sort, and its first run.

#include "stream/sort/run.h"

#include "stream/sort/run_log.h"
#include "tests/fuzz/allocations.h"
#include "tests/fuzz/small_cloud.h"
#include "tests/fuzz/target.h"

namespace pss::test {
namespace {

const std::string kFolder = "/runs";

StoreHeader plan() {
  StoreHeader header;
  header.schema = small_schema();
  header.inputs.count = 3;
  return header;
}

Result<RunInfo> write_run(const Schema& schema, std::uint64_t id) {
  PSS_ASSIGN(RunWriter writer, RunWriter::create(kFolder, id));
  for (const std::int64_t first : {0, 30}) {
    const auto positions = small_positions(30, first);
    PSS_TRY(writer.append(encode_key(positions[0]),
                          encode_block(schema, positions, small_rows(30, schema))));
  }
  return writer.finish();
}

/// Three runs, of which two are merged.
Result<void> write_runs(const StoreHeader& header) {
  PSS_ASSIGN(RunLog log, RunLog::open(kFolder, header));
  const std::vector<InputCounts> counts(3, {60, 1, 2, 3});
  for (std::uint64_t id = 0; id < 3; ++id) {
    PSS_ASSIGN(const RunInfo run, write_run(header.schema, id));
    PSS_TRY(id < 2 ? log.add(run, {id, 60 * (id + 1)}, {}, counts) : log.replace(1, run));
  }
  return {};
}

Result<void> read_run(const RunInfo& info, const Schema& schema) {
  PSS_ASSIGN(RunReader reader, RunReader::open(kFolder, info, schema));
  PSS_TRY(reader.seek(encode_key({45, 0, 0})));
  for (RunBlock block;;) {
    PSS_TRY(reader.next(block));
    if (block.count == 0) return {};
    std::vector<Key> keys(block.count);
    Bytes rows(block.count * schema.row_size());
    PSS_TRY(reader.decode(block, keys, rows));
  }
}

}  // namespace

std::vector<Bytes> seeds() {
  const SimulatedDisk disk;
  require(make_directories(kFolder).has_value() && write_runs(plan()).has_value(), "no runs");
  const Bytes parts[] = {disk.content(kFolder + "/log"), disk.content(run_path(kFolder, 1))};
  return {packed(parts)};
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pss;
  const auto parts = test::unpacked(std::as_bytes(std::span(data, size)), 2);
  test::SimulatedDisk disk;
  test::require(make_directories(test::kFolder).has_value(), "no folder");
  disk.put(test::kFolder + "/log", parts[0]);
  disk.put(run_path(test::kFolder, 1), parts[1]);
  const StoreHeader header = test::plan();
  const test::AllocationBound bound((4u << 20) + 64 * size);
  const auto log = RunLog::open(test::kFolder, header);
  if (!log) return 0;
  for (const RunInfo& run : log->state().runs)
    static_cast<void>(test::read_run(run, header.schema).has_value());
  return 0;
}
