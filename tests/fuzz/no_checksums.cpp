// Stands in for io/file/hash.cpp: every checksum is 0, so that changed bytes come past them.

#include "io/file/hash.h"

namespace pss {

std::uint64_t hash64(std::span<const std::byte> /*bytes*/, std::uint64_t /*seed*/) { return 0; }

std::string to_string(const Hash128& /*hash*/) { return {}; }

Hash128 hash128_from(std::string_view /*digits*/) { return {}; }

struct StreamHash::State {};

void StreamHash::Free::operator()(State* state) const { delete state; }

StreamHash::StreamHash() = default;

void StreamHash::update(std::span<const std::byte> /*bytes*/) {}

Hash128 StreamHash::digest() const { return {}; }

std::uint64_t StreamHash::digest64() const { return 0; }

}  // namespace pss
