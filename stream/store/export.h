#pragma once
// A store written as one file.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "io/file/output_file.h"
#include "io/points/format.h"
#include "stream/limit/memory.h"
#include "stream/store/store.h"

namespace pss {

struct ExportOptions {
  // Of formats with an integer grid.
  std::optional<World3> scale;   ///< default: the source file's, or one chosen for the bounds
  bool scale_auto = false;       ///< the finest scale that holds the bounds
  std::optional<World3> offset;  ///< default: as the scale's
  OutputRules rules;             ///< of the file that appears
  bool checked = false;          ///< check_export() has passed for what the rows were made from
};

struct ExportSummary {
  std::uint64_t points = 0;
  std::optional<Lattice> grid;  ///< of the file, where it has one
  std::vector<std::string> notes;
};

/// The grid that a file of a format with an integer grid gets, when it is written from a store.
///
/// `margin` widens the bounds that a grid is chosen for, where none is given.
Lattice export_grid(const StoreHeader& header, const WorldBox& bounds, double margin,
                    const ExportOptions& options);

/// Whether export_grid() chooses the scale for the bounds.
bool chooses_scale(const StoreHeader& header, const ExportOptions& options);

/// Refuses a scale and an offset that cannot hold the store's box. Costs nothing.
///
/// Errors: kBadInput, with the --scale or --offset that would do.
Result<void> check_export_box(const Store& store, double margin, const Format& format,
                              const ExportOptions& options);

/// Refuses what a file of a store could not hold, before any work goes into it. Returns what
/// should be known of a scale that was given by hand; empty for nothing.
///
/// Where positions will be rounded, the spacing of the points is measured in a pass over them.
/// Errors: kBadInput where the store's box does not fit the grid, with the --scale or --offset that
///         would do; where a chosen scale is too coarse for the spacing because of a far point:
///         `advice` leads to the --drop-outside that would do.
Result<std::string> check_export(
    const Store& store, double margin, const Format& format, const ExportOptions& options,
    Monitor& monitor, const char* advice = "make the store without such points, by pss tile with");

/// The head of a complete store's first input, where it is one for a file of this format's family.
///
/// Requires: reserve_header_and_head(), or reserve_inputs() of that input.
Result<std::optional<Carry>> carried_head(const Store& store, const Format& format);
/// The same of a table that has inputs.
Result<std::optional<Carry>> carried_head(const InputTable& inputs, const Format& format);

/// What export_store() takes of the limit, beside the header and the first input's head.
std::uint64_t export_memory(std::size_t row_size, std::uint64_t points);

/// Writes the rows of a complete store in order.
///
/// Requires: as carried_head().
/// Errors: kBadInput for a damaged or incomplete store, or a place that the format cannot hold;
///         kUsage for a scale or offset of a format without an integer grid.
Result<ExportSummary> export_store(const Store& store, const std::string& output,
                                   const ExportOptions& options, MemoryBudget& budget,
                                   Monitor& monitor);

/// The box of all rows of a store, on its lattice and in the world.
IndexBox bounds_of(const Store& store);
WorldBox world_bounds_of(const Store& store);

}  // namespace pss
