#pragma once
// SIGINT and SIGTERM as a flag that work looks at; a second SIGINT ends the process at once.

namespace pss {

/// Catches both signals while it lives; one at a time.
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
