#include "io/file/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <charconv>
#include <new>

namespace pss {
namespace {

XXH3_state_t* xxh(void* state) { return static_cast<XXH3_state_t*>(state); }

}  // namespace

std::uint64_t hash64(std::span<const std::byte> bytes, std::uint64_t seed) {
  return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

std::string to_string(const Hash128& hash) {
  return fmt::format("{:016x}{:016x}", hash.high, hash.low);
}

Hash128 hash128_from(std::string_view digits) {
  constexpr std::size_t kHalf = 16;
  Hash128 hash;
  if (digits.size() != 2 * kHalf) return hash;
  std::from_chars(digits.data(), digits.data() + kHalf, hash.high, 16);
  std::from_chars(digits.data() + kHalf, digits.data() + 2 * kHalf, hash.low, 16);
  return hash;
}

void StreamHash::Free::operator()(State* state) const { XXH3_freeState(xxh(state)); }

StreamHash::StreamHash() : state_(reinterpret_cast<State*>(XXH3_createState())) {
  if (!state_) throw std::bad_alloc();  // it comes from malloc, which gives none instead
  XXH3_128bits_reset(xxh(state_.get()));
}

void StreamHash::update(std::span<const std::byte> bytes) {
  XXH3_128bits_update(xxh(state_.get()), bytes.data(), bytes.size());
}

Hash128 StreamHash::digest() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(xxh(state_.get()));
  return {hash.high64, hash.low64};
}

/// The state is the same for both lengths of the hash.
std::uint64_t StreamHash::digest64() const { return XXH3_64bits_digest(xxh(state_.get())); }

}  // namespace pss
