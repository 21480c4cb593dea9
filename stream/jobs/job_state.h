#pragma once
// How far a job is, from what its work directory holds: `info WORKDIR`.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"

namespace pss {

struct JobState {
  std::string command;
  std::string output;
  std::string stage;  ///< "sort", the name of a pass, "write", "complete"
  std::uint64_t tiles_done = 0;
  std::uint64_t tiles = 0;  ///< 0 while unknown
  std::uint64_t points = 0;
  std::string parameters;  ///< JSON
  std::string spoiled;     ///< why it begins again; empty where it goes on
  std::vector<std::string> inputs;
  std::optional<std::string> holder;  ///< "process N on HOST" of a process that runs it now
};

/// Errors: kBadInput where the record or a store in the directory is damaged.
Result<JobState> read_job_state(const std::string& work_dir);

}  // namespace pss
