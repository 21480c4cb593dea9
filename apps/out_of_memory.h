#pragma once
// What happens when the system gives no more memory: one sentence and an exit code, in any thread.

#include <exception>

namespace pss {

/// From now on an allocation that fails ends the process, as a kill would: jobs stay resumable.
/// No exception could: one that leaves a thread of its own ends in std::terminate.
void exit_when_out_of_memory();

/// The same for what was thrown all the same, by a library or by a thread that got no stack; comes
/// back where that is something else.
void exit_if_out_of_memory(const std::exception_ptr& thrown);

}  // namespace pss
