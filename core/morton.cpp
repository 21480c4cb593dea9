#include "core/morton.h"

#include <bit>

namespace pss {
namespace {

constexpr std::uint64_t kHalfMask = (std::uint64_t{1} << 21) - 1;

/// Moves bit i of 21 to bit 3i.
std::uint64_t spread(std::uint64_t x) {
  x &= kHalfMask;
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  x = (x | x << 2) & 0x1249249249249249;
  return x;
}

/// The inverse of spread.
std::uint64_t gather(std::uint64_t x) {
  x &= 0x1249249249249249;
  x = (x ^ x >> 2) & 0x10c30c30c30c30c3;
  x = (x ^ x >> 4) & 0x100f00f00f00f00f;
  x = (x ^ x >> 8) & 0x001f0000ff0000ff;
  x = (x ^ x >> 16) & 0x001f00000000ffff;
  x = (x ^ x >> 32) & kHalfMask;
  return x;
}

/// The key bits below `level`, all set.
Key low_bits(int level) {
  const int bits = 3 * (kLatticeBits - level);
  const auto ones = [](int n) {
    return n >= 63 ? ~std::uint64_t{0} >> 1 : (std::uint64_t{1} << n) - 1;
  };
  return {bits > 63 ? ones(bits - 63) : 0, ones(bits)};
}

}  // namespace

Key encode_key(const Index3& index) {
  Key key;
  for (int a = 0; a < 3; ++a) {
    const auto biased =
        static_cast<std::uint64_t>(index[static_cast<std::size_t>(a)] - kLatticeMin);
    key.high |= spread(biased >> 21) << a;
    key.low |= spread(biased) << a;
  }
  return key;
}

Index3 decode_key(const Key& key) {
  Index3 index;
  for (int a = 0; a < 3; ++a) {
    const std::uint64_t biased = gather(key.high >> a) << 21 | gather(key.low >> a);
    index[static_cast<std::size_t>(a)] = static_cast<std::int64_t>(biased) + kLatticeMin;
  }
  return index;
}

Cell cell_of(const Key& key, int level) {
  const Key mask = low_bits(level);
  return {{key.high & ~mask.high, key.low & ~mask.low}, level};
}

Key last_key(const Cell& cell) {
  const Key mask = low_bits(cell.level);
  return {cell.first.high | mask.high, cell.first.low | mask.low};
}

bool contains(const Cell& cell, const Key& key) {
  return cell.first <= key && key <= last_key(cell);
}

int common_level(const Key& a, const Key& b) {
  if (a.high != b.high) return (std::countl_zero(a.high ^ b.high) - 1) / 3;
  if (a.low != b.low) return 21 + (std::countl_zero(a.low ^ b.low) - 1) / 3;
  return kLatticeBits;
}

}  // namespace pss
