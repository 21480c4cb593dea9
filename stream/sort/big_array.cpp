#include "stream/sort/big_array.h"

#include <sys/mman.h>

#include <new>
#include <utility>

namespace pss {

BigBytes::BigBytes(std::size_t size) : size_(size) {
  if (size == 0) return;
  void* const at = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) {  // as a vector would
    if (const std::new_handler handler = std::get_new_handler()) handler();
    throw std::bad_alloc();
  }
  // No huge pages: where the page cache fills the memory, making room for them costs the system
  // far more time than the fewer misses of the sort save.
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
