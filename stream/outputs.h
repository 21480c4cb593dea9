#pragma once
// The optional attributes of a projection: their names, and where they lie in a result row.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/projection.h"
#include "core/result.h"
#include "io/schema.h"

namespace pss {

/// What a user can ask for; the values are bits of an OutputSet.
enum Output : unsigned {
  kNormals = 1u << 0,
  kCurvature = 1u << 1,
  kDisplacement = 1u << 2,
  kResidual = 1u << 3,
  kNeighbors = 1u << 4,
  kBoundary = 1u << 5,
  kStatus = 1u << 6,
  kPrincipal = 1u << 7,
  kAllOutputs = (1u << 8) - 1,
};
using OutputSet = unsigned;

/// The value of a Status attribute: the status, and the flag of a second sheet.
std::uint8_t status_value(const Projection& projection);

/// "normals,curvature,..." or "all". Errors: kUsage naming the unknown word and the known ones.
Result<OutputSet> parse_outputs(const std::string& list);
/// The words of a set, in the order of their attributes.
std::vector<std::string> output_names(OutputSet set);

/// Appends the attributes of a set to a schema and writes them into its rows.
class OutputColumns {
 public:
  /// Extends `schema`. An attribute that is there already with the right type is overwritten.
  /// `prefix` goes before every name.
  ///
  /// Errors: kUsage where an attribute of that name has another type.
  static Result<OutputColumns> add_to(Schema& schema, OutputSet set, std::string_view prefix = {});

  void write(const Projection& projection, std::byte* row) const;

 private:
  struct Column {
    Output output;
    int part;              ///< which value of the output
    std::size_t position;  ///< in the row
    Type type;
  };
  std::vector<Column> columns_;
};

}  // namespace pss
