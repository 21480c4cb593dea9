#pragma once
// The optional attributes of a projection: their names, and where they lie in a result row.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/projection.h"
#include "core/result.h"
#include "io/points/schema.h"

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

/// An attribute of a scan whose place an output takes.
struct OutputClash {
  std::string attribute;
  std::string output;  ///< the name of the output's attribute
  std::string word;    ///< the output, as --outputs has it
};
/// The attributes of a schema that outputs take for their own: of the same name, in capitals or
/// not, as many programs do not tell these apart; and nx, ny, nz, which is what PLY calls the
/// normals.
std::vector<OutputClash> clashes_of(const Schema& schema, OutputSet set);

/// Bytes that a row with outputs takes over from the row without them.
struct KeptBytes {
  std::size_t from = 0;
  std::size_t to = 0;
  std::size_t size = 0;
};

/// Adds the attributes of a set to a schema and writes them into its rows.
class OutputColumns {
 public:
  /// Extends `schema`. An output takes the place of the attribute that it clashes with, with a type
  /// of its own; of several it takes the first, and the others go. All else is appended.
  /// `prefix` goes before every name; where there is one, only equal names clash.
  ///
  /// Errors: kUsage where an attribute shares its bytes with others, so that it cannot go.
  static Result<OutputColumns> add_to(Schema& schema, OutputSet set, std::string_view prefix = {});

  /// What the rows of the extended schema take over from those before, in row order.
  const std::vector<KeptBytes>& kept() const { return kept_; }

  void write(const Projection& projection, std::byte* row) const;

 private:
  void keep(const KeptBytes& bytes);
  struct Column {
    Output output;
    int part;              ///< which value of the output
    std::size_t position;  ///< in the row
    Type type;
  };
  std::vector<Column> columns_;
  std::vector<KeptBytes> kept_;
};

}  // namespace pss
