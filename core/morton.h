#pragma once
// Morton keys: the one order of points, and the octree cells that are ranges of it.

#include <compare>
#include <cstdint>

#include "core/lattice.h"

namespace pss {

/// The Morton code of a lattice position: bits of index + 2^41, x lowest in each triple.
///
/// 126 bits as two words of 63: `high` has the upper 21 bits of each axis, `low` the lower 21.
struct Key {
  std::uint64_t high = 0;
  std::uint64_t low = 0;

  auto operator<=>(const Key&) const = default;
};

Key encode_key(const Index3& index);
Index3 decode_key(const Key& key);

/// A cube of the lattice whose side is 2^(42 - level) steps: a contiguous range of keys.
struct Cell {
  Key first;      ///< smallest key in the cell
  int level = 0;  ///< 0: the whole lattice; 42: a single position

  bool operator==(const Cell&) const = default;
};

Cell cell_of(const Key& key, int level);
Key last_key(const Cell& cell);
bool contains(const Cell& cell, const Key& key);

/// The level of the smallest cell that holds both keys.
int common_level(const Key& a, const Key& b);

}  // namespace pss
