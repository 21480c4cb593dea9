#pragma once
// Writes points to one file in bounded memory; the file has its name only once it is complete.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/file/output_file.h"
#include "io/points/points.h"

namespace pss {

/// What a writer must know before the first point.
struct WriteOptions {
  Schema schema;                ///< of the rows that write() gets
  std::optional<Lattice> grid;  ///< of the positions that write() gets, where they are integers
  std::uint64_t count = 0;  ///< points to come; more is an error, fewer is corrected in the header
  std::optional<Carry> carry;  ///< header to carry on, used where its family is this one's
  double tolerance = 0;  ///< positions are known no better: text gets the shortest number this near
  std::optional<WorldBox> bounds;       ///< of the points to come; to choose scale and offset by
  std::optional<World3> scale, offset;  ///< integer grids: instead of carried or chosen ones
  /// The points to come are those of the carried header's file, all and in order: what its header
  /// says of them (bounds, counts) stays as it is.
  bool same_points = false;
  OutputRules rules;  ///< of the file that appears
};

class Writer {
 public:
  virtual ~Writer() = default;

  /// The grid that positions are rounded to, where the format has one; write() takes any position.
  virtual std::optional<Lattice> grid() const = 0;

  /// Notes for the report: dropped dimensions, a version change, dropped VLRs.
  virtual const std::vector<std::string>& notes() const = 0;

  /// Appends points in order. Positions with a grid equal to grid() are written as they are.
  ///
  /// Errors: kBadInput where a position cannot be held by the format; kFailed for I/O.
  virtual Result<void> write(const PointBatch& batch) = 0;

  /// Completes the header, syncs, and gives the file its name. Without it nothing stays.
  virtual Result<void> finish() = 0;
};

}  // namespace pss
