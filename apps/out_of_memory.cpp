#include "apps/out_of_memory.h"

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <exception>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "core/result.h"

namespace pss {

namespace {

constexpr std::string_view kSentence =
    "pss: the system gave no more memory; use a smaller --memory-limit or fewer --threads, a job "
    "goes on where it stopped\n";

/// Whether a message ends with the system's words for this error.
bool ends_with(std::string_view message, std::errc error) {
  return message.ends_with(std::make_error_code(error).message());
}

/// Whether this is what is thrown where not operator new, but the system refused memory: a thread
/// got no stack. The message decides, because TBB throws a plain runtime_error.
bool is_refusal(const std::exception_ptr& thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    return true;
  } catch (const std::runtime_error& error) {
    return ends_with(error.what(), std::errc::resource_unavailable_try_again) ||
           ends_with(error.what(), std::errc::not_enough_memory);
  } catch (...) {
  }
  return false;
}

/// Thread: any; only the first one speaks.
[[noreturn]] void exit_out_of_memory() {
  static std::atomic<bool> said{false};
  if (said.exchange(true))
    for (;;) pause();  // the thread that came first ends this one
  // Not stdio, which may allocate.
  static_cast<void>(!write(STDERR_FILENO, kSentence.data(), kSentence.size()));
  _exit(static_cast<int>(Fault::kFailed));
}

[[noreturn]] void on_terminate() {
  exit_if_out_of_memory(std::current_exception());
  std::abort();
}

}  // namespace

void exit_if_out_of_memory(const std::exception_ptr& thrown) {
  if (is_refusal(thrown)) exit_out_of_memory();
}

void exit_when_out_of_memory() {
  std::set_new_handler(exit_out_of_memory);
  std::set_terminate(on_terminate);
}

#ifndef __SANITIZE_ADDRESS__  // which has initializers of its own there
namespace {

/// The initializers of shared libraries allocate, too, before main() is called.
[[gnu::section(".preinit_array"),
  gnu::used]] void (*const before_libraries)() = exit_when_out_of_memory;

}  // namespace
#endif

}  // namespace pss
