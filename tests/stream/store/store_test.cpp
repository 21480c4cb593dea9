#include "stream/store/store.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/stream/store_fixture.h"
#include "tests/support/test_data.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

const std::vector<InputRecord> kInputs = {{"a b.las", 1000, -7, 99}, {"../ü.ply", 0, 1, 2}};

Carry rich_carry() { return {"PLY", std::vector<std::byte>(300, std::byte{4}), {std::byte{1}}}; }

StoreHeader rich_header() {
  StoreHeader header;
  header.lattice = {{0.01, 0.01, 0.001}, {500000, 4100000, -3.25}};
  header.schema = test::rich_schema();
  header.grid = header.lattice;
  header.inputs = digest_of(kInputs);
  header.parameters = R"({"radius":1.5})";
  return header;
}

constexpr std::size_t kRows = 10000;

/// Writes the table of inputs, and ends the store.
Result<void> finish(StoreWriter& writer, const std::string& summary, const Note& note = {}) {
  PSS_TRY(test::write_inputs(writer.path(), kInputs, rich_carry()));
  return writer.finish(summary, note);
}

/// A store of three tiles, the second of two blocks; finished or not.
test::Cloud make_store(const std::string& path, bool finished,
                       std::uint64_t segment_size = kSegmentSize) {
  const StoreHeader header = rich_header();
  test::Cloud cloud = test::random_cloud(kRows, 100000, header.schema.row_size(), 17);
  StoreWriter writer = expect_value(StoreWriter::create(path, header, segment_size));
  expect_ok(test::append_tile(writer, header.schema, cloud, 0, 1000));
  expect_ok(test::append_tile(writer, header.schema, cloud, 1000, 9000));
  expect_ok(test::append_tile(writer, header.schema, cloud, 9000, kRows));
  if (finished) expect_ok(finish(writer, R"({"kept":10000})"));
  return cloud;
}

void expect_equal(const test::Cloud& found, const test::Cloud& expected) {
  EXPECT_EQ(found.positions, expected.positions);
  EXPECT_EQ(found.rows, expected.rows);
}

TEST(Store, GivesBackHeaderTilesAndRows) {
  test::TemporaryDirectory folder;
  const auto cloud = make_store(folder / "s.pss", true);

  const Store store = expect_value(Store::open(folder / "s.pss"));

  EXPECT_EQ(store.header(), rich_header());
  EXPECT_TRUE(store.complete());
  EXPECT_EQ(store.summary(), R"({"kept":10000})");
  EXPECT_EQ(store.points(), kRows);
  ASSERT_EQ(store.tiles().size(), 3u);
  EXPECT_EQ(store.tiles()[1].first_row, 1000u);
  EXPECT_EQ(store.tiles()[1].blocks, 2u);
  EXPECT_EQ(store.tiles()[1].note, (Note{3, {std::byte{7}, std::byte{9}}}));
  EXPECT_EQ(store.tiles()[2].box, box_of(std::span(cloud.positions).subspan(9000)));
  expect_equal(expect_value(test::read_all(store)), cloud);
}

TEST(Store, ReadsOneFieldDensely) {
  test::TemporaryDirectory folder;
  const auto cloud = make_store(folder / "s.pss", true);
  const Store store = expect_value(Store::open(folder / "s.pss"));
  const auto blocks = expect_value(store.read_index(1));
  const std::size_t row = store.header().schema.row_size();
  const std::size_t at = store.header().schema.position(3);
  std::vector<std::byte> field(blocks[1].count * std::size_t{12});

  expect_ok(store.read_field(store.tiles()[1], blocks[1], 3, field));

  for (std::size_t i = 0; i < blocks[1].count; ++i)
    EXPECT_TRUE(std::equal(
        field.begin() + 12 * static_cast<std::ptrdiff_t>(i),
        field.begin() + 12 * static_cast<std::ptrdiff_t>(i + 1),
        cloud.rows.begin() + static_cast<std::ptrdiff_t>((blocks[1].first_row + i) * row + at)));
}

TEST(Store, SpreadsTilesOverSegments) {
  test::TemporaryDirectory folder;
  const auto cloud = make_store(folder / "s.pss", true, 1000);

  const Store store = expect_value(Store::open(folder / "s.pss"));

  EXPECT_EQ(store.tiles()[2].segment, 2u);
  EXPECT_TRUE(exists(segment_path(folder / "s.pss", 2)));
  expect_equal(expect_value(test::read_all(store)), cloud);
}

TEST(Store, HoldsNoPointsAtAllWhenNoneCame) {
  test::TemporaryDirectory folder;
  StoreWriter writer = expect_value(StoreWriter::create(folder / "s.pss", rich_header()));
  expect_ok(finish(writer, "{}"));

  const Store store = expect_value(Store::open(folder / "s.pss"));

  EXPECT_EQ(store.points(), 0u);
  EXPECT_TRUE(store.complete());
}

TEST(Store, HoldsEmptyTilesBetweenOthersAndTheNumbersOfTheirSources) {
  test::TemporaryDirectory folder;
  const StoreHeader header = rich_header();
  const test::Cloud cloud = test::random_cloud(600, 1000, header.schema.row_size(), 5);
  const Cell cell{};
  {
    StoreWriter writer = expect_value(StoreWriter::create(folder / "s.pss", header, 1000));
    expect_ok(writer.commit_tile(cell, 0));
    expect_ok(test::append_tile(writer, header.schema, cloud, 0, 300));  // of source tile 1
    expect_ok(writer.commit_tile(cell, 4, {1, {std::byte{3}}}));
    expect_ok(writer.commit_tile(cell, 6));
    expect_ok(test::append_tile(writer, header.schema, cloud, 300, 600));  // of source tile 7
    expect_ok(writer.commit_tile(cell, 8));
    EXPECT_EQ(writer.next_source(), 9u);
    expect_ok(finish(writer, "{}"));
  }

  const Store store = expect_value(Store::open(folder / "s.pss"));

  ASSERT_EQ(store.tiles().size(), 6u);
  constexpr std::uint64_t kSources[] = {0, 1, 4, 6, 7, 8};
  constexpr std::uint64_t kCounts[] = {0, 300, 0, 0, 300, 0};
  for (std::size_t t = 0; t < 6; ++t) {
    EXPECT_EQ(store.tiles()[t].source, kSources[t]);
    EXPECT_EQ(store.tiles()[t].count, kCounts[t]);
    EXPECT_EQ(store.tiles()[t].box.empty(), kCounts[t] == 0);
    EXPECT_EQ(expect_value(store.read_index(t)).empty(), kCounts[t] == 0);
  }
  EXPECT_EQ(store.tiles()[2].note, (Note{1, {std::byte{3}}}));
  EXPECT_EQ(store.tiles()[4].first_row, 300u);
  expect_equal(expect_value(test::read_all(store)), cloud);
}

TEST(Store, OfEmptyTilesAloneHasNoSegment) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  StoreWriter writer = expect_value(StoreWriter::create(path, rich_header()));
  for (std::uint64_t tile = 0; tile < 3; ++tile) expect_ok(writer.commit_tile(Cell{}, tile));
  expect_ok(finish(writer, "{}"));

  const Store store = expect_value(Store::open(path));

  EXPECT_EQ(store.tiles().size(), 3u);
  EXPECT_EQ(store.points(), 0u);
  EXPECT_FALSE(exists(segment_path(path, 0)));
  test::write_bytes(segment_path(path, 0), {});
  EXPECT_FALSE(check_removable(path)) << "a segment that no tile lies in is somebody else's";
}

TEST(StoreWriter, GoesOnBehindEmptyTiles) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  const StoreHeader header = rich_header();
  const test::Cloud cloud = test::random_cloud(200, 1000, header.schema.row_size(), 6);
  expect_ok(expect_value(StoreWriter::create(path, header)).commit_tile(Cell{}, 2));
  test::write_bytes(segment_path(path, 0), std::vector<std::byte>(50));  // of a tile not committed
  {
    StoreWriter writer = expect_value(StoreWriter::resume(path, header));
    EXPECT_EQ(writer.next_source(), 3u);
    expect_ok(test::append_tile(writer, header.schema, cloud, 0, 200));
    expect_ok(writer.commit_tile(Cell{}, 9));
  }
  const auto size = test::bytes_of(segment_path(path, 0)).size();
  {
    const StoreWriter writer = expect_value(StoreWriter::resume(path, header));
    EXPECT_EQ(writer.next_source(), 10u);
  }

  StoreWriter writer = expect_value(StoreWriter::resume(path, header));
  expect_ok(finish(writer, "{}"));

  EXPECT_EQ(test::bytes_of(segment_path(path, 0)).size(), size);
  const Store store = expect_value(Store::open(path));
  EXPECT_EQ(store.tiles()[1].source, 3u);
  expect_equal(expect_value(test::read_all(store)), cloud);
}

TEST(Store, RefusesTilesThatAreNotInTheOrderOfTheirSources) {
  Manifest manifest;
  manifest.has_header = true;
  TileInfo tile;
  const auto add = [&](std::uint64_t source) {
    tile.source = source;
    const auto bytes = encode_tile(tile);
    return manifest.add("m", {static_cast<std::uint32_t>(RecordType::kTile), 16, bytes});
  };

  EXPECT_TRUE(add(3).has_value());
  EXPECT_FALSE(add(3).has_value());
  EXPECT_FALSE(add(2).has_value());
  EXPECT_TRUE(add(4).has_value());
}

/// Tiles whose manifest records end within the first `size` bytes.
std::size_t tiles_within(std::size_t size, std::size_t header_end, std::size_t record) {
  return (size - header_end) / record;
}

TEST(StoreWriter, GoesOnAfterAManifestCutAtAnyByte) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  const auto cloud = make_store(path, false, 1000);
  const auto manifest = test::bytes_of(open_manifest_path(path));
  const std::string saved = folder / "saved";
  std::filesystem::copy(path, saved);
  make_store(folder / "whole.pss", true, 1000);
  const std::size_t header_end = 16 + 32 + encode_header(rich_header()).size();
  const std::size_t record = (manifest.size() - header_end) / 3;
  const std::size_t starts[] = {0, 1000, 9000, kRows};
  for (std::size_t size = header_end; size <= manifest.size(); ++size) {
    std::filesystem::remove_all(path);
    std::filesystem::copy(saved, path);
    std::filesystem::resize_file(open_manifest_path(path), size);

    StoreWriter writer = expect_value(StoreWriter::resume(path, rich_header(), 1000));

    ASSERT_EQ(writer.tiles().size(), tiles_within(size, header_end, record)) << size;
    if (size % 61 != 0) continue;  // going on from every state takes long, from some it is enough
    for (std::size_t t = writer.tiles().size(); t < 3; ++t)
      expect_ok(test::append_tile(writer, rich_header().schema, cloud, starts[t], starts[t + 1]));
    expect_ok(finish(writer, R"({"kept":10000})"));
    for (std::uint32_t n = 0; n < 3; ++n)
      ASSERT_EQ(test::bytes_of(segment_path(path, n)),
                test::bytes_of(segment_path(folder / "whole.pss", n)))
          << size;
    std::filesystem::remove(manifest_path(path));
  }
}

TEST(StoreWriter, CutsBytesOfATileThatWasNeverCommitted) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  const auto cloud = make_store(path, false);
  const auto before = test::bytes_of(segment_path(path, 0)).size();
  {
    StoreWriter writer = expect_value(StoreWriter::resume(path, rich_header()));
    expect_ok(test::append_tile(writer, rich_header().schema, cloud, 0, 10, false));
  }
  ASSERT_GT(test::bytes_of(segment_path(path, 0)).size(), before);

  const StoreWriter writer = expect_value(StoreWriter::resume(path, rich_header()));

  EXPECT_EQ(writer.tiles().size(), 3u);
  EXPECT_EQ(test::bytes_of(segment_path(path, 0)).size(), before);
}

TEST(StoreWriter, LeavesANoteOfTheWholeStoreAndItsOwnName) {
  test::TemporaryDirectory folder;
  const Note note{5, {std::byte{1}, std::byte{2}}};
  StoreWriter writer = expect_value(StoreWriter::create(folder / "s.pss", rich_header()));
  expect_ok(finish(writer, "{}", note));

  const Store store = expect_value(Store::open(folder / "s.pss"));

  EXPECT_EQ(store.note(), note);
  EXPECT_EQ(store.producer(), producer());
  EXPECT_TRUE(store.producer().starts_with("pss ")) << store.producer();
}

/// A store as `made_by` would have begun it, without any tile.
void begin_store(const std::string& path, const StoreHeader& header, std::string_view made_by) {
  expect_ok(make_directories(path));
  expect_value(LogWriter::create(open_manifest_path(path),
                                 static_cast<std::uint32_t>(RecordType::kHeader),
                                 encode_header(header, made_by)));
}

TEST(StoreWriter, DoesNotGoOnWithAStoreThatAnotherVersionOfPssBegan) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  begin_store(path, rich_header(), "pss 0.0.9");

  const auto writer = StoreWriter::resume(path, rich_header());

  ASSERT_FALSE(writer.has_value());
  EXPECT_EQ(writer.error().fault, Fault::kFailed);
  EXPECT_NE(writer.error().message.find("pss 0.0.9"), std::string::npos) << writer.error().message;
  EXPECT_NE(writer.error().message.find(producer()), std::string::npos) << writer.error().message;
  EXPECT_EQ(expect_value(Store::open(path)).producer(), "pss 0.0.9") << "it can be read";
}

TEST(Store, OfAnotherVersionOfTheFormatIsRefusedWithWhatToDo) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  std::vector<std::byte> header = encode_header(rich_header());
  header[0] = std::byte{1};
  expect_ok(make_directories(path));
  expect_value(LogWriter::create(open_manifest_path(path),
                                 static_cast<std::uint32_t>(RecordType::kHeader), header));

  for (const Result<void>& result :
       {Store::open(path).has_value() ? Result<void>() : Store::open(path).error(),
        StoreWriter::resume(path, rich_header()).has_value()
            ? Result<void>()
            : StoreWriter::resume(path, rich_header()).error()}) {
    ASSERT_FALSE(result.has_value());
    EXPECT_EQ(result.error().fault, Fault::kBadInput);
    for (const char* part : {"version 1 found", "version 2", "pss tile", "--restart"})
      EXPECT_NE(result.error().message.find(part), std::string::npos) << result.error().message;
  }
}

TEST(Note, OfAnotherVersionIsRefusedWithBoth) {
  const Note note{7, {std::byte{1}}};

  const auto refused = bytes_of(note, 2, "s.pss");

  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().fault, Fault::kBadInput);
  for (const char* part : {"s.pss", "version 7 found", "version 2"})
    EXPECT_NE(refused.error().message.find(part), std::string::npos) << refused.error().message;
  EXPECT_EQ(expect_value(bytes_of(note, 7, "s.pss")).size(), 1u);
  EXPECT_TRUE(expect_value(bytes_of({}, 7, "s.pss")).empty()) << "nothing was said";
  EXPECT_FALSE(bytes_of({0, {std::byte{1}}}, 7, "s.pss").has_value());
}

TEST(StoreWriter, FinishesTheNameOfAStoreKilledBeforeTheRename) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  make_store(path, true);
  std::filesystem::rename(manifest_path(path), open_manifest_path(path));

  const StoreWriter writer = expect_value(StoreWriter::resume(path, rich_header()));

  EXPECT_TRUE(writer.complete());
  EXPECT_TRUE(exists(manifest_path(path)));
}

TEST(StoreWriter, RefusesToResumeAStoreOfOtherParameters) {
  test::TemporaryDirectory folder;
  make_store(folder / "s.pss", false);
  StoreHeader other = rich_header();
  other.parameters = R"({"radius":2})";

  const auto writer = StoreWriter::resume(folder / "s.pss", other);

  ASSERT_FALSE(writer.has_value());
  EXPECT_EQ(writer.error().fault, Fault::kFailed);
}

TEST(StoreWriter, DoesNotRemoveADirectoryThatIsNoStore) {
  test::TemporaryDirectory folder;
  std::filesystem::create_directory(folder / "photos.pss");
  test::write_bytes(folder / "photos.pss/thesis.txt", {});

  const auto writer = StoreWriter::create(folder / "photos.pss", rich_header());

  ASSERT_FALSE(writer.has_value());
  EXPECT_TRUE(exists(folder / "photos.pss/thesis.txt"));
}

/// Opens the store and reads everything in it.
Result<test::Cloud> open_and_read(const std::string& path) {
  PSS_ASSIGN(const Store store, Store::open(path));
  PSS_ASSIGN(const InputTable inputs, store.inputs());
  PSS_TRY(inputs.check());
  return test::read_all(store);
}

TEST(Store, FindsAFlippedBitInEveryFileAndNamesIt) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  make_store(path, true);
  for (const std::string& name : {manifest_path(path), inputs_path(path), segment_path(path, 0)}) {
    const std::size_t bits = 8 * test::bytes_of(name).size();
    const std::size_t step = name != segment_path(path, 0) ? 7 : 8 * 997 + 3;
    for (std::size_t bit = 0; bit < bits; bit += step) {
      test::flip_bit(name, bit);

      const auto found = open_and_read(path);

      ASSERT_FALSE(found.has_value()) << name << " bit " << bit;
      EXPECT_EQ(found.error().fault, Fault::kBadInput);
      EXPECT_NE(found.error().message.find(name), std::string::npos) << found.error().message;
      EXPECT_NE(found.error().message.find("offset"), std::string::npos) << found.error().message;
      test::flip_bit(name, bit);
    }
  }
}

TEST(Store, FindsASegmentCutShort) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  make_store(path, true);
  const auto whole = test::bytes_of(segment_path(path, 0));
  for (const std::size_t size : {std::size_t{0}, whole.size() / 2, whole.size() - 1}) {
    test::write_bytes(segment_path(path, 0), std::span(whole).first(size));
    EXPECT_FALSE(Store::open(path).has_value()) << size;
  }
}

TEST(Store, WithoutOneOfItsSegmentsIsDamaged) {
  test::TemporaryDirectory folder;
  const std::string path = folder / "s.pss";
  make_store(path, true);
  expect_ok(remove_file(segment_path(path, 0)));

  const auto store = Store::open(path);

  ASSERT_FALSE(store.has_value());
  EXPECT_EQ(store.error().fault, Fault::kBadInput);
  EXPECT_NE(store.error().message.find(segment_path(path, 0)), std::string::npos);
}

}  // namespace
}  // namespace pss
