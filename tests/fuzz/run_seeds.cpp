// Where there is no fuzzer: feeds a target its seeds, and changes of them that are always the same.
//
//   fuzz_las              seeds, then mutations; one that ends the program is left in
//   fuzz_las.input fuzz_las FILE...      these files, as a fuzzer or a failure left them fuzz_las
//   --write DIR  nothing: writes the seeds, for a fuzzer to begin with

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <new>

#include "tests/fuzz/mutate.h"
#include "tests/fuzz/target.h"

namespace pss::test {
namespace {

constexpr std::size_t kMutations = 20000;

void write(const std::string& path, const Bytes& bytes) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()),
             static_cast<std::streamsize>(bytes.size()));
}

Bytes read(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return bytes_of(text);
}

void feed(const Bytes& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

void write_seeds(const std::string& folder) {
  std::size_t number = 0;
  for (const Bytes& seed : seeds()) write(folder + "/seed-" + std::to_string(number++), seed);
}

/// The n-th of the seeds, an empty input, the mutations.
Bytes input(const std::vector<Bytes>& seeds, std::size_t n) {
  if (n <= seeds.size()) return n < seeds.size() ? seeds[n] : Bytes();
  std::mt19937_64 random(n - seeds.size());
  return mutated(seeds, random);
}

/// In another process, of which this one knows how far it came.
bool feed_all(const std::string& left) {
  const std::vector<Bytes> all = seeds();
  void* shared =
      mmap(nullptr, sizeof(std::size_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  require(shared != MAP_FAILED, "no shared memory");
  std::atomic<std::size_t>& n = *new (shared) std::atomic<std::size_t>(0);
  const pid_t child = fork();
  if (child == 0) {
    for (; n <= all.size() + kMutations; ++n) feed(input(all, n));
    return true;
  }
  int status = -1;
  waitpid(child, &status, 0);
  if (status == 0) return true;
  write(left, input(all, n));
  std::fprintf(stderr, "ended by the input that is now in %s\n", left.c_str());
  return false;
}

}  // namespace
}  // namespace pss::test

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv, argv + argc);
  if (words.size() == 1) return pss::test::feed_all(words[0] + ".input") ? 0 : 1;
  if (words.size() == 3 && words[1] == "--write") {
    pss::test::write_seeds(words[2]);
  } else {
    for (std::size_t i = 1; i < words.size(); ++i) pss::test::feed(pss::test::read(words[i]));
  }
  return 0;
}
