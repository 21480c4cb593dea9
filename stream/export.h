#pragma once
// A store written as one file.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "io/output_file.h"
#include "stream/memory.h"
#include "stream/store.h"

namespace pss {

struct ExportOptions {
  std::optional<World3> scale;   ///< LAS; default: the source file's, or one chosen for the bounds
  bool scale_auto = false;       ///< LAS: the finest scale that holds the bounds
  std::optional<World3> offset;  ///< LAS
  OutputRules rules;             ///< of the file that appears
};

struct ExportSummary {
  std::uint64_t points = 0;
  std::optional<Lattice> grid;  ///< of the file, where it has one
  std::vector<std::string> notes;
};

/// The grid that a file written from a store gets; empty where the format has none.
///
/// `margin` widens the bounds that a grid is chosen for, where none is given.
std::optional<Lattice> export_grid(const StoreHeader& header, const IndexBox& bounds, double margin,
                                   Format format, const ExportOptions& options);

/// Refuses a grid that does not hold all positions of a store, before any work is done for them.
///
/// Errors: kBadInput naming the axis, where the points are, and what the grid holds.
Result<void> check_grid(const Store& store, const std::string& output, Format format,
                        const ExportOptions& options);

/// Writes the rows of a complete store in order.
///
/// Errors: kBadInput for a damaged or incomplete store, or a place that the format cannot hold;
///         kUsage for a scale or offset without a LAS output.
Result<ExportSummary> export_store(const Store& store, const std::string& output,
                                   const ExportOptions& options, MemoryBudget& budget,
                                   Monitor& monitor);

/// The box of all rows of a store.
IndexBox bounds_of(const Store& store);

}  // namespace pss
