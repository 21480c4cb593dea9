// A store: its manifest, record by record, and the tiles of its first segment.

#include "stream/store/store.h"

#include "stream/store/export.h"
#include "stream/store/store_writer.h"
#include "stream/store/verify.h"
#include "tests/fuzz/allocations.h"
#include "tests/fuzz/small_cloud.h"
#include "tests/fuzz/target.h"
#include "tests/io/formats/las/las_bytes.h"

namespace pss::test {
namespace {

const std::string kStore = "/a.pss";
constexpr std::uint64_t kLimit = std::uint64_t{128} << 20;

const std::vector<InputRecord> kInputs = {{"/a.las", 7, 8, 9}, {"/b.las", 1, 2, 3}};

/// Of the store's inputs, and the file that it is exported as.
struct FormatChoice {
  const char* name;
  const char* output;
};
constexpr FormatChoice kChoices[] = {
    {"LAS", "/out.las"}, {"PLY", "/out.ply"}, {"text", "/out.csv"}};

StoreHeader header() {
  StoreHeader header;
  header.schema = small_schema();
  header.lattice = {{0.01, 0.01, 0.01}, {1, 2, 3}};
  header.grid = header.lattice;
  header.inputs = digest_of(kInputs);
  header.parameters = "{}";
  return header;
}

/// Two inputs with heads of a format, the second without a grid or a coordinate system.
Result<void> write_inputs(const char* format, const Bytes& carried) {
  PSS_ASSIGN(InputTableWriter table, InputTableWriter::create(kStore, kInputs.size()));
  const Carry carry{.family = format, .head = carried, .tail = {}};
  const Lattice grid{{0.01, 0.01, 0.01}, {1, 2, 3}};
  PSS_TRY(table.add({kInputs[0], format, grid, {40, 1, 2, 3}}, "EPSG:2994", carry));
  PSS_TRY(table.add({kInputs[1], "unknown", {}, {}}, "", carry));
  return table.finish();
}

/// Two tiles of two blocks each, and an empty one.
Result<void> write_store(const char* format, const Bytes& carried) {
  const StoreHeader header = test::header();
  PSS_ASSIGN(StoreWriter writer, StoreWriter::create(kStore, header));
  for (const std::int64_t first : {0, 64}) {
    for (const std::int64_t block : {0, 20})
      PSS_TRY(writer.append(encode_block(header.schema, small_positions(20, first + block),
                                         small_rows(20, header.schema))));
    PSS_TRY(writer.commit_tile(cell_of(encode_key({first, 0, 0}), kLatticeBits - 6),
                               writer.next_source()));
  }
  PSS_TRY(writer.commit_tile(cell_of(encode_key({128, 0, 0}), kLatticeBits - 6),
                             writer.next_source() + 2));
  PSS_TRY(write_inputs(format, carried));
  return writer.finish("{}");
}

Bytes written(unsigned char choice, std::string_view carried) {
  const SimulatedDisk disk;
  require(write_store(kChoices[choice].name, bytes_of(carried)).has_value(),
          "cannot write a store");
  const Bytes parts[] = {{std::byte{choice}},
                         disk.content(manifest_path(kStore)),
                         disk.content(inputs_path(kStore)),
                         disk.content(segment_path(kStore, 0))};
  return packed(parts);
}

/// Every part of a table of inputs; it may be of other inputs than the header's.
void use_inputs(const Store& store) {
  const auto inputs = InputTable::open(store.path());
  if (!inputs) return;
  for (std::size_t i = 0; i < inputs->size(); ++i) {
    static_cast<void>(inputs->facts(i).has_value());
    static_cast<void>(inputs->crs(i).has_value());
    const auto size = inputs->head_size(i);
    const auto head = inputs->head(i);
    require(!head || !*head || (*head)->head.size() + (*head)->tail.size() <= *size,
            "a head is larger than it said");
  }
}

/// Everything that reads a store: opening, verifying, exporting, going on with it.
void use(const FormatChoice& choice, bool finished) {
  MemoryBudget budget(kLimit, 1);
  Monitor monitor;
  const auto checked = verify_store(kStore, budget, monitor);
  const auto store = Store::open(kStore);
  require(checked.has_value() <= store.has_value(), "verified what cannot be opened");
  if (!store) return require(store.error().fault == Fault::kBadInput, store.error().message);
  if (store->complete()) use_inputs(*store);
  const auto exported = export_store(*store, choice.output, {}, budget, monitor);
  require(!exported || exported->points == store->points(), "exported another number of points");
  if (!finished) static_cast<void>(StoreWriter::resume(kStore, store->header()).has_value());
}

}  // namespace

std::vector<Bytes> seeds() {
  return {written(0, las({.format = 1})),
          written(1,
                  "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\n"
                  "property float y\nproperty float z\nend_header\n"),
          written(2,
                  "pss text 1\nextension csv\nseparator ,\ncounted 0\naxes 0 1 2\n"
                  "header \ncolumn x\ncolumn y\ncolumn z\ncolumn GpsTime\n")};
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace pss;
  const auto parts = test::unpacked(std::as_bytes(std::span(data, size)), 4);
  const unsigned choice = parts[0].empty() ? 0 : static_cast<unsigned>(parts[0][0]);
  const bool finished = choice < 128;
  test::SimulatedDisk disk;
  test::require(make_directories(test::kStore).has_value(), "no folder");
  disk.put(finished ? manifest_path(test::kStore) : open_manifest_path(test::kStore), parts[1]);
  disk.put(inputs_path(test::kStore), parts[2]);
  disk.put(segment_path(test::kStore, 0), parts[3]);
  const test::AllocationBound bound(test::kLimit + 256 * size);
  test::use(test::kChoices[choice % 3], finished);
  return 0;
}
