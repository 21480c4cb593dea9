#pragma once
// What the user's state folder remembers of finished jobs, whose work directories are gone.

#include <optional>
#include <string>

#include "core/result.h"
#include "io/file/content_hash.h"

namespace pss {

struct FinishedOutput {
  std::string identity;  ///< identity_of() the job
  FileContent content;   ///< of OUTPUT, or of its store's manifest
};

/// Remembers what became of `output`: one small file for each real path, in place of an older one.
///
/// `state_folder` is made where it is missing; an empty one remembers nothing.
Result<void> remember_finished(const std::string& state_folder, const std::string& output,
                               const FinishedOutput& finished);

/// What is remembered of `output`; nothing where that cannot be read or is damaged.
std::optional<FinishedOutput> recall_finished(const std::string& state_folder,
                                              const std::string& output);

}  // namespace pss
