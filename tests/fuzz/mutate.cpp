#include "tests/fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <cstring>

namespace pss::test {
namespace {

using Random = std::mt19937_64;

std::ptrdiff_t place_in(const Bytes& bytes, Random& random) {
  return static_cast<std::ptrdiff_t>(random() % (bytes.size() + 1));
}

void flip_bit(Bytes& bytes, Random& random) {
  if (!bytes.empty()) bytes[random() % bytes.size()] ^= static_cast<std::byte>(1u << random() % 8);
}

void cut(Bytes& bytes, Random& random) { bytes.resize(random() % (bytes.size() + 1)); }

void erase(Bytes& bytes, Random& random) {
  const auto begin = bytes.begin() + place_in(bytes, random);
  const auto most = static_cast<std::uint64_t>(bytes.end() - begin);
  bytes.erase(begin, begin + static_cast<std::ptrdiff_t>(std::min(most, 1 + random() % 32)));
}

void repeat(Bytes& bytes, Random& random) {
  const auto begin = bytes.begin() + place_in(bytes, random);
  const auto most = static_cast<std::uint64_t>(bytes.end() - begin);
  const Bytes piece(begin, begin + static_cast<std::ptrdiff_t>(std::min(most, 1 + random() % 64)));
  bytes.insert(bytes.begin() + place_in(bytes, random), piece.begin(), piece.end());
}

/// Over 1, 2, 4 or 8 bytes: a number at an edge, or near the size of the file.
void put_number(Bytes& bytes, Random& random) {
  constexpr std::array<std::uint64_t, 8> kEdges{
      0, 1, 0x7F, 0x7FFF, 0x7FFFFFFF, 0x7FFFFFFFFFFFFFFF, 0x8000000000000000, ~std::uint64_t{0}};
  const std::uint64_t value =
      random() % 2 ? kEdges[random() % kEdges.size()] : bytes.size() + random() % 5 - 2;
  const std::size_t width = std::size_t{1} << random() % 4;
  if (bytes.size() < width) return;
  std::memcpy(bytes.data() + random() % (bytes.size() - width + 1), &value, width);
}

/// In place of a text's digits from some place on.
void put_digits(Bytes& bytes, Random& random) {
  constexpr std::array<std::string_view, 8> kNumbers{
      "0", "-1", "1e999", "nan", "255", "4294967296", "18446744073709551615", ""};
  const auto is_digit = [](std::byte b) { return b >= std::byte{'0'} && b <= std::byte{'9'}; };
  const auto begin = std::find_if(bytes.begin() + place_in(bytes, random), bytes.end(), is_digit);
  const auto at = bytes.erase(begin, std::find_if_not(begin, bytes.end(), is_digit));
  const Bytes number = bytes_of(kNumbers[random() % kNumbers.size()]);
  bytes.insert(at, number.begin(), number.end());
}

void splice(Bytes& bytes, std::span<const Bytes> inputs, Random& random) {
  const Bytes& other = inputs[random() % inputs.size()];
  cut(bytes, random);
  bytes.insert(bytes.end(), other.begin() + place_in(other, random), other.end());
}

}  // namespace

Bytes mutated(std::span<const Bytes> inputs, Random& random) {
  constexpr std::array kChanges{flip_bit, cut, erase, repeat, put_number, put_number, put_digits};
  Bytes bytes = inputs[random() % inputs.size()];
  if (random() % 8 == 0) splice(bytes, inputs, random);
  const std::uint64_t changes = 1 + random() % 4;
  for (std::uint64_t i = 0; i < changes; ++i) kChanges[random() % kChanges.size()](bytes, random);
  return bytes;
}

}  // namespace pss::test
