#pragma once
// Whether the disk has room for the runs and the store, before they are written.

#include <cstdint>
#include <string>

#include "core/monitor.h"
#include "core/result.h"
#include "stream/ingest.h"

namespace pss {

/// The most that runs and store together take: nothing compressed.
std::uint64_t disk_bound(const Schema& schema, std::uint64_t points);

/// What is still to be written.
struct DiskWork {
  std::uint64_t run_points = 0;
  std::uint64_t store_points = 0;
};

/// Compares the free space with what is needed: the bound, and where that does not fit, what the
/// first points of the input say, compressed.
///
/// Errors: kFailed with the numbers; kBadInput where the input cannot be read.
Result<void> check_disk(const IngestPlan& plan, const DiskWork& work, const std::string& store_path,
                        const std::string& work_dir, const Monitor& monitor);

}  // namespace pss
