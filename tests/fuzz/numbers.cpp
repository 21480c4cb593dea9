// Numbers as text: beside the C library's, and there and back.

#include "io/points/numbers.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "tests/fuzz/allocations.h"
#include "tests/fuzz/target.h"

namespace pss::test {
namespace {

constexpr std::array kTypes{Type::kInt8,    Type::kUint8,  Type::kInt16, Type::kUint16,
                            Type::kInt32,   Type::kUint32, Type::kInt64, Type::kUint64,
                            Type::kFloat32, Type::kFloat64};

/// strtod reads the same numbers in plain decimal notation, and blanks and hexadecimal ones too.
bool is_plain(const std::string& token) {
  return !token.empty() && token.find_first_not_of("0123456789+-.eE") == std::string::npos;
}

void compare_with_c(const std::string& token) {
  char* end = nullptr;
  const double expected = std::strtod(token.c_str(), &end);
  double value = 0;
  const NumberFault fault = parse_number(token, value);
  const bool whole = end == token.c_str() + token.size();
  require((fault != NumberFault::kNoNumber) == whole, "a number for one of the two: " + token);
  require(!whole || (fault == NumberFault::kOutOfRange) == std::isinf(expected),
          "out of range for one of the two: " + token);
  require(fault != NumberFault::kNone || std::memcmp(&value, &expected, sizeof value) == 0,
          "another number: " + token);
}

void there_and_back(std::string_view token, Type type) {
  std::array<std::byte, 8> value{}, again{};
  if (parse_number(token, type, value.data()) != NumberFault::kNone) return;
  std::string text;
  append_number(type, value.data(), text);
  const NumberFault fault = parse_number(text, type, again.data());
  require(fault == NumberFault::kNone && (value == again || text.ends_with("nan")),
          "another number back: " + text);
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> all;
  for (const std::string_view text :
       {"0", "-1", "+12.5e3", "1e-400", "nan", "-inf", "255", "18446744073709551615", "1e999",
        "9007199254740993", "-9223372036854775808", "4.9e-324", "3.4028236e38", "-.5", "7."})
    all.push_back(bytes_of(text));
  return all;
}

}  // namespace pss::test

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string token(reinterpret_cast<const char*>(data), size);
  const pss::test::AllocationBound bound((1u << 16) + 32 * size);
  if (pss::test::is_plain(token)) pss::test::compare_with_c(token);
  for (const pss::Type type : pss::test::kTypes) pss::test::there_and_back(token, type);
  return 0;
}
