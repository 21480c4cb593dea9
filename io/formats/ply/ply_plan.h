#pragma once
// Which properties a PLY file to be written has, and where each of them comes from.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/formats/ply/ply_header.h"
#include "io/points/schema.h"
#include "io/points/writer.h"

namespace pss {

/// The source of a property: a coordinate, or an element of a dimension.
struct PlySource {
  Type type = Type::kFloat64;            ///< of the property
  std::optional<std::size_t> axis = {};  ///< 0 to 2: a coordinate
  Dimension dimension = {};              ///< otherwise this
  std::size_t element = 0;
  bool verbatim = false;  ///< the stored bytes are the property's
};

struct PlyPlan {
  PlyHeader header;                ///< one element: vertex
  std::vector<PlySource> sources;  ///< one a property
  std::vector<std::string> notes;
};

/// Errors: kBadInput where a carried header cannot be read.
Result<PlyPlan> plan_ply(const std::string& path, const WriteOptions& options);

}  // namespace pss
