#pragma once
// Which columns a text file to be written has, and where each of them comes from.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/formats/text/text_layout.h"
#include "io/points/schema.h"
#include "io/points/writer.h"

namespace pss {

/// The source of a column: a coordinate, or an element of a dimension.
struct TextSource {
  std::optional<std::size_t> axis = {};
  Dimension dimension = {};
  std::size_t element = 0;
};

struct TextPlan {
  TextLayout layout;
  std::vector<TextSource> sources;  ///< one a column
  std::vector<std::string> notes;
};

/// Errors: kBadInput where a carried layout cannot be read.
Result<TextPlan> plan_text(const std::string& path, const WriteOptions& options);

}  // namespace pss
