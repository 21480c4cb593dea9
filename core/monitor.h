#pragma once
// How long work tells that it advances, and hears that it should stop.

#include <cstdint>
#include <string_view>

namespace pss {

/// Watches one run; the default watches nothing and never stops.
///
/// Thread: any thread may call any of these.
class Monitor {
 public:
  virtual ~Monitor() = default;

  /// A stage begins ("read", "sort", "smooth", "write"...); `total` 0 means unknown.
  virtual void begin(std::string_view /*stage*/, std::uint64_t /*total_points*/,
                     std::uint64_t /*total_tiles*/ = 0) {}
  /// So much more is done in this stage.
  virtual void advance(std::uint64_t /*points*/, std::uint64_t /*tiles*/ = 0) {}
  /// Something the user should know, once.
  virtual void note(std::string_view /*text*/) {}
  /// Whether to stop soon: return Error{kInterrupted}, leaving what is on disk resumable.
  virtual bool stopping() const { return false; }
};

}  // namespace pss
