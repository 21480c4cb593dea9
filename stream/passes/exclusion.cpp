#include "stream/passes/exclusion.h"

#include <algorithm>

namespace pss {
namespace {

constexpr double kLowPoint = 7;
constexpr double kHighNoise = 18;

/// The field in which a byte of the row lies.
std::size_t field_at(const Schema& schema, std::size_t position) {
  std::size_t field = 0;
  while (field + 1 < schema.fields().size() && schema.position(field + 1) <= position) ++field;
  return field;
}

}  // namespace

Exclusion::Exclusion(const Schema& schema) {
  for (const char* name : {"Classification", "Withheld"}) {
    const std::optional<Dimension> in_row = schema.dimension(name);
    if (!in_row) continue;
    Test test{field_at(schema, in_row->position), *in_row, in_row->name[0] == 'C'};
    test.in_field.position -= schema.position(test.field);
    add(schema, test);
  }
}

void Exclusion::add(const Schema& schema, const Test& test) {
  if (schema.fields()[test.field].size() != 1) return tests_.push_back(test);
  auto table = std::ranges::find(byte_tests_, test.field, &ByteTest::field);
  if (table == byte_tests_.end()) table = byte_tests_.insert(table, {test.field, {}});
  for (std::size_t value = 0; value < table->excluded.size(); ++value) {
    const auto byte = static_cast<std::byte>(value);
    if (hit(test, read_value(test.in_field, &byte))) table->excluded[value] = 1;
  }
}

bool Exclusion::hit(const Test& test, double value) {
  return test.classification ? value == kLowPoint || value == kHighNoise : value != 0;
}

Result<void> Exclusion::mark(const Store& store, const TileInfo& tile, const BlockInfo& block,
                             std::span<std::uint8_t> excluded) const {
  std::fill(excluded.begin(), excluded.end(), std::uint8_t{0});
  std::vector<std::byte> values;
  for (const ByteTest& test : byte_tests_) {
    values.resize(block.count);
    PSS_TRY(store.read_field(tile, block, test.field, values));
    for (std::size_t i = 0; i < block.count; ++i)
      excluded[i] |= test.excluded[static_cast<std::size_t>(values[i])];
  }
  for (const Test& test : tests_) {
    const std::size_t size = store.header().schema.fields()[test.field].size();
    values.resize(size * block.count);
    PSS_TRY(store.read_field(tile, block, test.field, values));
    for (std::size_t i = 0; i < block.count; ++i)
      if (hit(test, read_value(test.in_field, values.data() + i * size))) excluded[i] = 1;
  }
  return {};
}

}  // namespace pss
