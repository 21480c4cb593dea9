#include "tests/fuzz/target.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace pss::test {
namespace {

/// Larger files make fewer inputs a second, and hold nothing that these lack.
constexpr std::uintmax_t kLargestSeed = 48 << 10;

Bytes content_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return bytes_of(text);
}

}  // namespace

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

std::vector<Bytes> real_files(std::string_view extension) {
  const char* named = std::getenv("PSS_TEST_DATA");
  const std::filesystem::path folder = named ? named : PSS_SHARED_DATA;
  if (!std::filesystem::exists(folder)) return {};
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().extension() == extension &&
        entry.file_size() <= kLargestSeed)
      paths.push_back(entry.path());
  std::ranges::sort(paths);
  std::vector<Bytes> files;
  std::ranges::transform(paths, std::back_inserter(files), content_of);
  return files;
}

void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what.c_str());
  std::abort();
}

Bytes packed(std::span<const Bytes> parts) {
  Bytes all;
  for (const Bytes& part : parts.first(parts.size() - 1)) {
    const auto size = static_cast<std::uint32_t>(part.size());
    const auto bytes = std::as_bytes(std::span(&size, 1));
    all.insert(all.end(), bytes.begin(), bytes.end());
  }
  for (const Bytes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

std::vector<std::span<const std::byte>> unpacked(std::span<const std::byte> input,
                                                 std::size_t count) {
  std::vector<std::uint32_t> sizes(count - 1);
  const std::size_t head = std::min(input.size(), std::as_bytes(std::span(sizes)).size());
  std::copy_n(input.begin(), head, std::as_writable_bytes(std::span(sizes)).begin());
  input = input.subspan(head);
  std::vector<std::span<const std::byte>> parts;
  for (const std::size_t size : sizes) {
    parts.push_back(input.first(std::min(size, input.size())));
    input = input.subspan(parts.back().size());
  }
  parts.push_back(input);
  return parts;
}

}  // namespace pss::test
