#pragma once
// What makes a failure final: a writer that failed once does not write again.

#include <optional>

#include "core/result.h"

namespace pss {

/// Remembers the first failure of a writer.
///
/// After a failed sync the system may have forgotten what it could not write, and the next sync
/// succeed: nothing that follows a failure may be taken as done.
class FirstFailure {
 public:
  /// Gives what `write` returns, or, without calling it, the failure there was before.
  template <class Write>
  Result<void> guard(const Write& write) {
    if (failure_) return *failure_;
    Result<void> done = write();
    if (!done) failure_ = done.error();
    return done;
  }

 private:
  std::optional<Error> failure_;
};

}  // namespace pss
