#pragma once
// What running an operator over all tiles took.

#include <cstdint>

namespace pss {

/// What a run did and what it waited for.
struct ScheduleSummary {
  std::uint64_t tiles = 0;          ///< done in this run
  std::uint64_t resumed_tiles = 0;  ///< found done
  std::uint64_t parts = 0;
  std::uint64_t reloaded_parts = 0;  ///< times that candidates were loaded again, farther out
  std::uint64_t own_points = 0;
  std::uint64_t halo_points = 0;
  double compute_seconds = 0;
  double wait_seconds = 0;    ///< compute waiting, for any of the following
  double wait_reading = 0;    ///< for a part to be loaded
  double wait_memory = 0;     ///< for memory that finished parts held
  double wait_commit = 0;     ///< for the last parts to be written
  double load_seconds = 0;    ///< of the reader's thread
  double encode_seconds = 0;  ///< of the committer's thread: compressing
  double write_seconds = 0;   ///< and writing
  double seconds = 0;
};

}  // namespace pss
