// A tile's block: the columns of positions and fields.

#include "stream/store/block.h"

#include <algorithm>

#include "stream/store/bytes.h"
#include "tests/fuzz/allocations.h"
#include "tests/fuzz/small_cloud.h"
#include "tests/fuzz/target.h"

namespace pss::test {
namespace {

/// The first bytes choose what the rest is said to be: a field's type and lanes, the number of
/// rows.
struct Claim {
  Field field;
  std::size_t count;
  std::span<const std::byte> column;
};

Claim claim_of(std::span<const std::byte> input) {
  ByteReader reader(input);
  Claim claim;
  claim.field.type = static_cast<Type>(reader.get<std::uint8_t>() % 10);
  claim.field.count = 1 + reader.get<std::uint8_t>() % 16u;
  claim.count = 1 + reader.get<std::uint16_t>() % kBlockPoints;
  claim.column = input.last(input.size() - std::min<std::size_t>(4, input.size()));
  return claim;
}

Bytes claimed(Type type, std::uint8_t lanes, std::size_t count, std::span<const std::byte> column) {
  Bytes input;
  ByteWriter writer(input);
  writer.put(static_cast<std::uint8_t>(type));
  writer.put<std::uint8_t>(static_cast<std::uint8_t>(lanes - 1));
  writer.put(static_cast<std::uint16_t>(count - 1));
  writer.raw(column);
  return input;
}

/// What was decoded is encoded and decoded to the same again.
void field_there_and_back(const Claim& claim) {
  const Schema schema({claim.field});
  Bytes rows(claim.count * schema.row_size()), again(rows.size());
  if (!decode_field(claim.field, claim.column, claim.count, rows.data(), schema.row_size())) return;
  const EncodedBlock block = encode_block(schema, small_positions(claim.count), rows);
  const auto column = std::span(block.bytes).subspan(block.columns[1].offset);
  require(decode_field(claim.field, column, claim.count, again.data(), schema.row_size()) &&
              rows == again,
          "other values back");
}

void positions_there_and_back(const Claim& claim) {
  std::vector<Index3> positions(claim.count), again(claim.count);
  if (!decode_positions(claim.column, positions)) return;
  const EncodedBlock block = encode_block(Schema(), positions, {});
  require(decode_positions(block.bytes, again) && positions == again, "other positions back");
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  const Schema schema = small_schema();
  for (const std::size_t count : {std::size_t{1}, std::size_t{20}, std::size_t{kBlockPoints}}) {
    const EncodedBlock block =
        encode_block(schema, small_positions(count), small_rows(count, schema));
    for (std::size_t c = 0; c < block.columns.size(); ++c) {
      const Field field = c == 0 ? Field() : schema.fields()[c - 1];
      all.push_back(
          claimed(field.type, static_cast<std::uint8_t>(field.count), count,
                  std::span(block.bytes).subspan(block.columns[c].offset, block.columns[c].size)));
    }
  }
  return all;
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto claim = pss::test::claim_of(std::as_bytes(std::span(data, size)));
  // Rows are the claim of whoever calls: at most 4096 of 16 values, some of them twice.
  const pss::test::AllocationBound bound((6u << 20) + 4 * size);
  pss::test::field_there_and_back(claim);
  pss::test::positions_there_and_back(claim);
  return 0;
}
