#pragma once
// SIGINT and SIGTERM: the end of the process, or, while work goes on, a flag that it looks at. And
// the signals that would end it without a word.

namespace pss {

/// From now on both signals end the process with exit code 130, unless a SignalWatch lives.
void exit_on_signals();

/// From now on a write to a pipe without a reader (SIGPIPE), or one that makes a file larger than
/// the process may (SIGXFSZ), fails as any other: the failure is told, or ignored where only words
/// are lost.
void let_writes_fail();

/// Catches both signals while it lives, one at a time; a second SIGINT ends the process at once.
class SignalWatch {
 public:
  SignalWatch();
  ~SignalWatch();
  SignalWatch(const SignalWatch&) = delete;
  SignalWatch& operator=(const SignalWatch&) = delete;

  /// Whether a signal has come since the watch began. Thread: any.
  bool stopping() const;
};

}  // namespace pss
