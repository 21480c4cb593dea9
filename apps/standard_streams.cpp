#include "apps/standard_streams.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

#include "io/file/disk.h"

namespace pss {

namespace {

constexpr int kInput = 0, kOutput = 1, kErrors = 2;
constexpr const char* kNothing = "/dev/null";

bool is_closed(int descriptor) {
  disk::Status status;
  return disk::status(descriptor, status) == -EBADF;
}

Error failure(std::string_view what, int number) {
  const std::error_code code(number, std::generic_category());
  return {Fault::kFailed, fmt::format("{}: {}", what, code.message())};
}

}  // namespace

Result<void> open_missing_streams() {
  for (const int descriptor : {kInput, kOutput, kErrors}) {
    if (!is_closed(descriptor)) continue;
    // The system gives the lowest free number, and those below are open by now. A stdout that can
    // only be read refuses what is written to it.
    const auto how = descriptor == kErrors ? disk::Open::kReadWrite : disk::Open::kRead;
    const disk::Outcome opened = disk::open(kNothing, how);
    if (opened < 0) return failure("cannot open /dev/null", static_cast<int>(-opened));
  }
  return {};
}

Result<void> print_data(std::string_view data) {
  if (std::fwrite(data.data(), 1, data.size(), stdout) == data.size() && std::fflush(stdout) == 0)
    return {};
  return failure("cannot write to stdout", errno);
}

void print_words(std::string_view words) {
  static_cast<void>(std::fwrite(words.data(), 1, words.size(), stderr));
}

}  // namespace pss
