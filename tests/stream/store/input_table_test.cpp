#include "stream/store/input_table.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "core/parallel.h"
#include "stream/store/verify.h"
#include "tests/io/formats/las/las_bytes.h"
#include "tests/stream/ingest_fixture.h"

namespace pss {
namespace {

using test::expect_ok;
using test::expect_value;

const std::vector<InputRecord> kInputs = {
    {"a b.las", 1000, -7, 99}, {"../ü.ply", 0, 1, 2}, {"c.xyz", 3, 4, 5}};

Carry carry_of(std::size_t bytes) {
  return {"PLY", std::vector<std::byte>(bytes, std::byte{4}), {std::byte{1}}};
}

TEST(InputTable, GivesBackWhatWasWrittenOfEachInput) {
  test::TemporaryDirectory folder;
  {
    auto table = expect_value(InputTableWriter::create(folder.path().string(), 3));
    expect_ok(table.add(test::facts_of(kInputs[0]), "EPSG:2994", carry_of(300)));
    expect_ok(table.add({kInputs[1], "of the future", {}, {}}, "", carry_of(20)));
    expect_ok(table.add({kInputs[2], "text", {}, {}}, "", {}));
    expect_ok(table.finish());
  }

  const auto table = expect_value(InputTable::open(folder.path().string(), 3));

  ASSERT_EQ(table.size(), 3u);
  EXPECT_EQ(expect_value(table.facts(0)), test::facts_of(kInputs[0]));
  EXPECT_EQ(expect_value(table.facts(2)).record, kInputs[2]);
  EXPECT_FALSE(expect_value(table.facts(2)).grid);
  EXPECT_EQ(expect_value(table.crs(0)), "EPSG:2994");
  EXPECT_EQ(expect_value(table.crs(1)), "");
  EXPECT_EQ(expect_value(table.head(0)), carry_of(300));
  EXPECT_FALSE(expect_value(table.head(1))) << "this program does not know the format";
  EXPECT_FALSE(expect_value(table.head(2))) << "it has none";
  EXPECT_GE(expect_value(table.head_size(0)), 300u + 9);
  EXPECT_GE(expect_value(table.head_size(1)), 20u);
  EXPECT_EQ(expect_value(table.head_size(2)), 0u);
  EXPECT_EQ(expect_value(table.check()), digest_of(kInputs));
}

TEST(InputTable, DigestTellsInputsTheirOrderAndTheirNumber) {
  std::vector<InputRecord> turned(kInputs.rbegin(), kInputs.rend());
  std::vector<InputRecord> changed = kInputs;
  changed[1].modified_ns = 8;

  EXPECT_EQ(digest_of(kInputs).count, 3u);
  EXPECT_NE(digest_of(kInputs), digest_of(turned));
  EXPECT_NE(digest_of(kInputs), digest_of(changed));
  EXPECT_NE(digest_of(kInputs), digest_of(std::span(kInputs).first(2)));
}

TEST(InputTable, OfAnotherNumberOfInputsIsDamaged) {
  test::TemporaryDirectory folder;
  expect_ok(test::write_inputs(folder.path().string(), kInputs, carry_of(9)));

  const auto found = InputTable::open(folder.path().string(), 2);

  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().fault, Fault::kBadInput);
  EXPECT_NE(found.error().message.find("3 inputs found, 2 expected"), std::string::npos)
      << found.error().message;
}

/// What reading every part of a table gives.
Result<void> read_all_of(const std::string& folder) {
  PSS_ASSIGN(const InputTable table, InputTable::open(folder, kInputs.size()));
  for (std::size_t i = 0; i < table.size(); ++i) {
    PSS_TRY(table.facts(i));
    PSS_TRY(table.crs(i));
    PSS_TRY(table.head(i));
  }
  return {};
}

TEST(InputTable, CutAnywhereOrWithABitFlippedIsDamaged) {
  test::TemporaryDirectory folder;
  auto table = expect_value(InputTableWriter::create(folder.path().string(), 3));
  for (const InputRecord& input : kInputs) {  // the last one ends with its facts
    const bool last = input == kInputs.back();
    expect_ok(
        table.add(test::facts_of(input), last ? "" : "EPSG:1", last ? Carry{} : carry_of(40)));
  }
  const std::string path = inputs_path(folder.path().string());
  const auto whole = test::bytes_of(path);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    test::write_bytes(path, std::span(whole).first(size));
    ASSERT_FALSE(InputTable::open(folder.path().string(), kInputs.size())) << size;
  }
  test::write_bytes(path, whole);
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += 3) {
    test::flip_bit(path, bit);

    const auto read = read_all_of(folder.path().string());

    ASSERT_FALSE(read) << bit;
    EXPECT_EQ(read.error().fault, Fault::kBadInput);
    EXPECT_NE(read.error().message.find(path + ": damaged at offset"), std::string::npos)
        << read.error().message;
    test::flip_bit(path, bit);
  }
  expect_ok(read_all_of(folder.path().string()));
}

TEST(InputTable, DamagedInOneEntryGivesTheOthers) {
  test::TemporaryDirectory folder;
  expect_ok(test::write_inputs(folder.path().string(), kInputs, carry_of(5000)));
  const std::string path = inputs_path(folder.path().string());
  test::flip_bit(path, 8 * (test::bytes_of(path).size() - 100));  // in the head of the last

  const auto table = expect_value(InputTable::open(folder.path().string(), kInputs.size()));

  EXPECT_EQ(expect_value(table.head(0)), carry_of(5000));
  EXPECT_EQ(expect_value(table.facts(2)), test::facts_of(kInputs[2], 2));
  EXPECT_FALSE(table.head(2));
  EXPECT_FALSE(table.check());
}

TEST(InputTable, IsCopiedWholeOrNotAtAll) {
  test::TemporaryDirectory folder;
  for (const char* name : {"from", "to"}) std::filesystem::create_directory(folder / name);
  expect_ok(test::write_inputs(folder / "from", kInputs, carry_of(700000)));
  test::write_bytes(inputs_path(folder / "to"), {});  // of a killed writer

  expect_ok(copy_inputs(folder / "from", folder / "to"));

  EXPECT_EQ(test::bytes_of(inputs_path(folder / "to")),
            test::bytes_of(inputs_path(folder / "from")));
  test::flip_bit(inputs_path(folder / "from"), 8 * 1000000);
  const auto refused = copy_inputs(folder / "from", folder / "to");
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find(inputs_path(folder / "from")), std::string::npos);
}

class StoreInputs : public testing::Test {
 protected:
  StoreInputs() {
    test::write_cloud(folder_ / "a.las", test::sheet(9000, 2));
    test::Cloud cloud = test::sheet(7000, 3);
    for (const std::size_t far : {5u, 6000u}) cloud.positions[far] = {900000, 900000, 0};
    test::write_cloud(folder_ / "b.las", cloud);
    options_.drop_outside = WorldBox{{499000, 4099000, -100}, {501000, 4101000, 100}};
  }

  InputTable table_of(const std::string& name, std::uint64_t total) {
    test::ingest_files(folder_, name, {folder_ / "a.las", folder_ / "b.las"}, options_, total);
    return expect_value(expect_value(Store::open(folder_ / (name + ".pss"))).inputs());
  }

  test::TemporaryDirectory folder_;
  IngestOptions options_ = test::small_tiles(700);
};

TEST_F(StoreInputs, HaveTheirOwnHeadsGridsAndCountsHoweverTheyAreSorted) {
  const ThreadLimit threads(2);  // they decide how much memory is left for a chunk
  const std::pair<const char*, std::uint64_t> sortings[] = {{"at once", 64u << 20},
                                                            {"by runs", 3800u << 10}};
  for (const auto& [name, total] : sortings) {
    const InputTable table = table_of(name, total);

    ASSERT_EQ(table.size(), 2u);
    const InputFacts a = expect_value(table.facts(0));
    const InputFacts b = expect_value(table.facts(1));
    EXPECT_EQ(a.counts, (InputCounts{9000, 0, 0, 0}));
    EXPECT_EQ(b.counts, (InputCounts{7000, 0, 2, 0}));
    EXPECT_EQ(a.record.path, folder_ / "a.las");
    EXPECT_EQ(a.format, "LAS");
    EXPECT_EQ(b.grid, test::las_grid());
    EXPECT_EQ(expect_value(table.head(1)),
              expect_value(open_reader(folder_ / "b.las"))->header().carry);
  }
}

TEST_F(StoreInputs, OfAnotherStoreAreFoundByVerify) {
  table_of("s", 64 << 20);
  const std::string path = folder_ / "s.pss";
  const auto table = expect_value(InputTable::open(path));
  InputFacts first = expect_value(table.facts(0));
  const Carry carry = *expect_value(table.head(0));
  const InputFacts second = expect_value(table.facts(1));
  first.record.size += 1;
  auto writer = expect_value(InputTableWriter::create(path, 2));
  for (const InputFacts& facts : {first, second}) expect_ok(writer.add(facts, "", carry));
  expect_ok(writer.finish());
  MemoryBudget budget = test::budget_of(64 << 20);
  Monitor monitor;

  const auto found = expect_value(verify_store(path, budget, monitor));

  ASSERT_EQ(found.damage_count, 1u);
  EXPECT_NE(found.damage[0].find(inputs_path(path)), std::string::npos) << found.damage[0];
  EXPECT_FALSE(check_bytes(path, monitor));
}

TEST_F(StoreInputs, MissingOrCutAreDamage) {
  table_of("s", 64 << 20);
  const std::string path = folder_ / "s.pss";
  const auto whole = test::bytes_of(inputs_path(path));
  test::write_bytes(inputs_path(path), std::span(whole).first(whole.size() - 1));
  const auto cut = Store::open(path);
  expect_ok(remove_file(inputs_path(path)));
  const auto missing = Store::open(path);

  for (const auto* store : {&cut, &missing}) {
    ASSERT_FALSE(*store);
    EXPECT_EQ(store->error().fault, Fault::kBadInput);
    EXPECT_NE(store->error().message.find(inputs_path(path)), std::string::npos);
  }
}

TEST_F(StoreInputs, WithALargerHeadThanTheFirstAreRefusedBeforeTheyAreSorted) {
  test::LasFile file{.points = 3, .vlr_count = 200};
  for (std::uint32_t i = 0; i < file.vlr_count; ++i)
    file.vlrs += test::vlr("someone", 1, std::string(60000, 'a'));
  test::write_text(folder_ / "b.las", test::las(file));
  options_.drop_outside.reset();
  Monitor monitor;
  const auto plan =
      expect_value(plan_ingest({folder_ / "a.las", folder_ / "b.las"}, options_, monitor));
  for (const std::uint64_t total : {30u << 20, 40u << 20}) {
    MemoryBudget budget = test::budget_of(total);

    const auto summary =
        ingest(plan, folder_ / "s.pss", folder_ / "s.work", options_, budget, monitor);

    EXPECT_EQ(summary.has_value(), total == 40u << 20);
    if (summary) continue;
    EXPECT_EQ(summary.error().fault, Fault::kMemoryLimit);
    EXPECT_NE(summary.error().message.find("b.las"), std::string::npos);
    EXPECT_FALSE(exists(folder_ / "s.pss"));
  }
}

}  // namespace
}  // namespace pss
