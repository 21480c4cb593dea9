#pragma once
// Which points are no neighbours of others: withheld points and the noise classes 7 and 18.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/result.h"
#include "io/points/schema.h"
#include "stream/store/store.h"

namespace pss {

/// Decides by the Classification and Withheld dimensions, where a schema has them.
class Exclusion {
 public:
  explicit Exclusion(const Schema& schema);

  /// Whether any point of this schema can be excluded.
  bool active() const { return !tests_.empty() || !byte_tests_.empty(); }

  /// Marks the excluded points of a block, reading only the fields that decide.
  ///
  /// Shape: `excluded` has block.count elements, set to 0 or 1.
  Result<void> mark(const Store& store, const TileInfo& tile, const BlockInfo& block,
                    std::span<std::uint8_t> excluded) const;

 private:
  struct Test {
    std::size_t field;    ///< the field that holds the value
    Dimension in_field;   ///< where it lies in the field alone
    bool classification;  ///< noise classes exclude; otherwise any value but zero
  };
  /// Where the field is a single byte: the answer to each of its values, for all tests of it.
  struct ByteTest {
    std::size_t field;
    std::array<std::uint8_t, 256> excluded;
  };
  static bool hit(const Test& test, double value);
  void add(const Schema& schema, const Test& test);
  std::vector<Test> tests_;
  std::vector<ByteTest> byte_tests_;
};

}  // namespace pss
