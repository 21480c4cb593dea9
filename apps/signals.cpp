#include "apps/signals.h"

#include <signal.h>
#include <unistd.h>

#include <atomic>

namespace pss {

namespace {

constexpr int kExitInterrupted = 130;

std::atomic<bool> signalled{false};  // the one global: a handler reaches nothing else
static_assert(std::atomic<bool>::is_always_lock_free);

void on_signal(int number) {
  if (signalled.exchange(true) && number == SIGINT) _exit(kExitInterrupted);
}

void exit_at_once(int) { _exit(kExitInterrupted); }

void install(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;  // file operations go on; the work stops where it can
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace

void exit_on_signals() { install(exit_at_once); }

void let_writes_fail() {
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN);
}

SignalWatch::SignalWatch() {
  signalled = false;
  install(on_signal);
}

SignalWatch::~SignalWatch() { exit_on_signals(); }

bool SignalWatch::stopping() const { return signalled.load(std::memory_order_relaxed); }

}  // namespace pss
