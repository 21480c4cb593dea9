#pragma once
// Whether the disk has room for the runs and the store, before they are written.

#include <cstdint>
#include <string>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/sort/ingest.h"

namespace pss {

/// Bytes that a point takes in a run or in the store, from samples spread over all inputs, sorted
/// and compressed as they will be.
///
/// Rather too much than too little: no sample is denser than a run of `chunk_points`, and of every
/// attribute the sample counts that takes the most.
/// Errors: kBadInput where the input cannot be read; kInterrupted.
/// Cost:   twice reads, sorts and compresses up to 2^18 points.
Result<double> sample_bytes(const IngestPlan& plan, bool source_column, std::uint64_t chunk_points,
                            const Monitor& monitor);

/// What is still to be written.
struct DiskWork {
  std::uint64_t run_points = 0;
  std::uint64_t store_points = 0;
  std::uint64_t chunk_points = 0;  ///< a run has at most so many
  bool source_column = false;
};

/// Compares the free space with what is needed: the bound, and where that does not fit, what a
/// sample says.
///
/// Errors: kFailed with the numbers; kBadInput where the input cannot be read.
Result<void> check_disk(const IngestPlan& plan, const DiskWork& work, const std::string& store_path,
                        const std::string& work_dir, const Monitor& monitor);

}  // namespace pss
