#pragma once
// Copies points from files of any format to one file of any format, in order and bounded memory.

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "core/monitor.h"
#include "core/result.h"
#include "io/file/file.h"
#include "io/file/output_file.h"
#include "io/points/reader.h"

namespace pss {

struct ConvertOptions {
  std::optional<World3> scale;   ///< integer grids; default: the first input's, or one chosen
  std::optional<World3> offset;  ///< integer grids
  std::optional<WorldBox> drop_outside;  ///< points outside this box are left out, and counted
  bool overwrite = false;
  BeforeRename before_rename = {};  ///< called when the file is whole, before it gets its name
};

struct ConvertSummary {
  std::uint64_t points_in = 0;
  std::uint64_t points_out = 0;
  std::map<std::string, std::uint64_t> dropped;  ///< points, by reason; out = in - all of these
  std::vector<std::string> notes;                ///< what was odd in the input or changes in form
};

/// Writes all points of some files as one file of the format that its name asks for.
///
/// Every attribute is kept, in the union of the inputs' attributes; LAS to LAS keeps header, VLRs,
/// records and EVLRs as they are. Points without a finite position are dropped, and counted, where
/// the format cannot hold them. Inputs are read twice where their bounds or count must be known
/// first. Without success there is nothing under the output's name that was not there before.
///
/// Errors: kUsage for an unknown extension, a scale or offset for a format without an integer grid,
/// and a store as
///         an input; kBadInput for damaged files and for coordinate systems that differ;
///         kInterrupted where the monitor says so; kFailed for I/O, and where an input changes
///         before the output has its name.
Result<ConvertSummary> convert(const std::vector<std::string>& inputs, const std::string& output,
                               const ConvertOptions& options, Monitor& monitor);

/// The same from open readers, each at its first point.
Result<ConvertSummary> copy_points(std::span<Reader* const> readers, const std::string& output,
                                   const ConvertOptions& options, Monitor& monitor);

}  // namespace pss
