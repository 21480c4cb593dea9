#pragma once
// Reads a scan's file into memory, as benchmarks want it.

#include <string>

#include "core/sorted_cloud.h"

namespace pss::bench {

/// All points on the lattice of the file, or a fine one, in key order.
///
/// Errors: those of reading it.
Result<SortedCloud> read_scan(const std::string& path);

/// The name of a file without its folder.
std::string file_name(const std::string& path);

}  // namespace pss::bench
