#pragma once
// Checksums of bytes: XXH3, which finds damage but not malice.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace pss {

std::uint64_t hash64(std::span<const std::byte> bytes, std::uint64_t seed = 0);

struct Hash128 {
  std::uint64_t high = 0;
  std::uint64_t low = 0;

  bool operator==(const Hash128&) const = default;
};

/// 32 hexadecimal digits, as xxhsum prints them.
std::string to_string(const Hash128& hash);
/// Reads them again; another text gives a hash that nothing has but by chance.
Hash128 hash128_from(std::string_view digits);

/// The 128-bit hash of a stream of bytes, however it is cut into pieces.
class StreamHash {
 public:
  StreamHash();
  void update(std::span<const std::byte> bytes);
  Hash128 digest() const;
  /// hash64() of the same bytes.
  std::uint64_t digest64() const;

 private:
  struct State;
  struct Free {
    void operator()(State* state) const;
  };
  std::unique_ptr<State, Free> state_;
};

}  // namespace pss
