// A library to preload: the n-th allocation of a program fails, once or from then on.
//
// PSS_FAIL_ALLOCATION=N or N+; counted from the moment the program installs its new-handler. What
// comes before is the loader's. PSS_COUNT_ALLOCATIONS=FILE leaves the number of them in a file.

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <new>

// The C library's own functions, under the names that it keeps for those who stand in for them.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

std::atomic<bool> counting{false};
std::atomic<unsigned long> count{0};
unsigned long failing = 0;
bool ever_after = false;

bool fails() {
  if (!counting) return false;
  const unsigned long n = ++count;
  if (n != failing && !(ever_after && n > failing && failing > 0)) return false;
  errno = ENOMEM;
  return true;
}

void start_counting() {
  if (const char* text = std::getenv("PSS_FAIL_ALLOCATION")) {
    char* rest = nullptr;
    failing = std::strtoul(text, &rest, 10);
    ever_after = *rest == '+';
  }
  counting = true;
}

__attribute__((destructor)) void leave_count() {
  counting = false;
  const char* path = std::getenv("PSS_COUNT_ALLOCATIONS");
  if (!path) return;
  if (std::FILE* file = std::fopen(path, "w")) {
    std::fprintf(file, "%lu\n", count.load());
    std::fclose(file);
  }
}

}  // namespace

std::new_handler std::set_new_handler(std::new_handler handler) noexcept {
  using Install = std::new_handler (*)(std::new_handler);
  const auto next = reinterpret_cast<Install>(dlsym(RTLD_NEXT, "_ZSt15set_new_handlerPFvvE"));
  const std::new_handler before = next(handler);
  start_counting();
  return before;
}

extern "C" {

void* malloc(std::size_t size) { return fails() ? nullptr : __libc_malloc(size); }

void* calloc(std::size_t number, std::size_t size) {
  return fails() ? nullptr : __libc_calloc(number, size);
}

void* realloc(void* old, std::size_t size) { return fails() ? nullptr : __libc_realloc(old, size); }

void* memalign(std::size_t alignment, std::size_t size) {
  return fails() ? nullptr : __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }

int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  void* found = memalign(alignment, size);
  if (!found) return ENOMEM;
  *out = found;
  return 0;
}

}  // extern "C"
