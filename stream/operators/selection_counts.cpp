#include "stream/operators/selection_counts.h"

#include <array>
#include <cstring>

namespace pss {

void SelectionCounts::add(const SelectionCounts& other) {
  kept += other.kept;
  low += other.low;
  high += other.high;
  excluded += other.excluded;
}

std::vector<std::byte> SelectionCounts::to_bytes() const {
  const std::array<std::uint64_t, 4> numbers{kept, low, high, excluded};
  std::vector<std::byte> bytes(sizeof numbers);
  std::memcpy(bytes.data(), numbers.data(), sizeof numbers);
  return bytes;
}

SelectionCounts SelectionCounts::from_bytes(std::span<const std::byte> bytes) {
  std::array<std::uint64_t, 4> numbers{};
  if (bytes.size() == sizeof numbers) std::memcpy(numbers.data(), bytes.data(), sizeof numbers);
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

Result<SelectionCounts> SelectionCounts::from_note(const Note& note, const std::string& store) {
  PSS_ASSIGN(const std::span<const std::byte> bytes, bytes_of(note, kVersion, store));
  return from_bytes(bytes);
}

}  // namespace pss
