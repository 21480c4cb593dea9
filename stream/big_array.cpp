#include "stream/big_array.h"

#include <sys/mman.h>

#include <new>
#include <utility>

namespace pss {
namespace {

/// Two huge pages: one of them lies within the array for certain.
constexpr std::size_t kWorthHugePages = std::size_t{4} << 20;

}  // namespace

BigBytes::BigBytes(std::size_t size) : size_(size) {
  if (size == 0) return;
  void* const at = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) throw std::bad_alloc();  // as a vector would
  // It is advice: without huge pages all is the same, only slower.
  if (size >= kWorthHugePages) madvise(at, size, MADV_HUGEPAGE);
  data_ = static_cast<std::byte*>(at);
}

BigBytes::BigBytes(BigBytes&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

BigBytes& BigBytes::operator=(BigBytes&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

BigBytes::~BigBytes() {
  if (data_) munmap(data_, size_);
}

}  // namespace pss
