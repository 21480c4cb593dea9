#pragma once
// What a fuzz target is: a function that eats any bytes, and inputs near which to look.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/simulated_disk.h"

/// Ends the program where the bytes do harm; the name is the fuzzer's.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace pss::test {

using Bytes = std::vector<std::byte>;

/// Inputs to begin with: small ones made by the target itself, and real files where there are any.
std::vector<Bytes> seeds();

Bytes bytes_of(std::string_view text);

/// The real files with an extension (".las") that are small enough to be changed often.
std::vector<Bytes> real_files(std::string_view extension);

/// Ends the program with a sentence where what must hold does not.
void require(bool holds, const std::string& what);

/// A disk in memory that holds one file.
class OneFile {
 public:
  OneFile(std::string path, std::span<const std::byte> bytes) : path_(std::move(path)) {
    disk_.put(path_, bytes);
  }
  const std::string& path() const { return path_; }

 private:
  SimulatedDisk disk_;
  std::string path_;
};

/// Several files in one input: the sizes of all but the last, then one behind the other.
Bytes packed(std::span<const Bytes> parts);
/// Any bytes as `count` files.
std::vector<std::span<const std::byte>> unpacked(std::span<const std::byte> input,
                                                 std::size_t count);

}  // namespace pss::test
