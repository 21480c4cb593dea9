#pragma once
// Decides what a LAS file to be written looks like: version, point format, VLRs, grid, row.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "io/formats/las/las_header.h"
#include "io/points/writer.h"

namespace pss {

/// The file up to its points and behind them, but for what only the points can tell.
struct LasPlan {
  LasHeader header;
  std::vector<std::byte> head;  ///< all bytes up to the points; header fields are stored at the end
  std::vector<std::byte> tail;  ///< EVLRs
  Schema schema;                ///< of the rows in the file
  bool keeps_layout = false;    ///< head and row are those of the carried header
  bool legacy_counts = true;    ///< whether the 32-bit counts are filled where they can be
  std::vector<std::string> notes;
};

/// Carries the input's header on where there is one, and changes only what the schema needs. Takes
/// the carried bytes from `options`.
///
/// Errors: kBadInput where the attributes do not fit into a LAS record.
Result<LasPlan> plan_las(const std::string& path, WriteOptions& options);

/// The schema with PLY's and text's usual names (red, gps_time) as LAS has them, where the LAS
/// field holds every value of the attribute.
Schema with_las_names(const Schema& schema);

}  // namespace pss
