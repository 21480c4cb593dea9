#pragma once
// What reading all positions shows before any is rounded: where they lie, and how far apart.

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "core/monitor.h"
#include "core/result.h"
#include "core/world_sample.h"
#include "io/points/reader.h"

namespace pss {

/// A position and the record that it was read from.
struct ReadPosition {
  std::size_t input = 0;
  std::uint64_t record = 0;
  World3 at{};
};

/// The positions of some inputs, read in order.
class PositionSurvey {
 public:
  void add(std::size_t input, std::uint64_t record, const World3& position);

  const WorldBox& bounds() const { return bounds_; }
  const WorldSample& sample() const { return sample_; }

  /// The position that stretches the box most, and along which axis: of the two ends of the
  /// longest side the one farther from the sample's middle. Requires: positions.
  struct Farthest {
    ReadPosition position;
    std::size_t axis = 0;
  };
  Farthest farthest() const;

 private:
  WorldBox bounds_;
  std::array<ReadPosition, 3> low_, high_;  ///< the first of all that reach so far, an axis each
  WorldSample sample_;
};

/// How many points a reading of a file found, and where.
struct Extent {
  std::uint64_t records = 0;  ///< also those whose positions are passed over
  WorldBox bounds;            ///< of the others
};

/// Reads what follows of `reader` and measures it. Positions that are not finite, or outside
/// `kept`, which may be absent, are passed over; `visit` is called for each of the others with the
/// number of its record.
///
/// Errors: those of reading; kInterrupted.
Result<Extent> read_positions(Reader& reader, const std::optional<WorldBox>& kept, Monitor& monitor,
                              const std::function<void(std::uint64_t, const World3&)>& visit);

/// Passes the positions of a reader to a meter. Errors: those of reading; kInterrupted.
Result<void> measure_positions(Reader& reader, const std::optional<WorldBox>& kept,
                               SpacingMeter& meter, Monitor& monitor);

/// The refusal of `step`, which is too coarse for this spacing because of a far position.
///
/// It names file, record and coordinate, and the --drop-outside that would do: a box of which a
/// side has at least `steps_a_side` steps. `advice` leads to it, as in "leave it out with".
Error too_far(const PositionSurvey& survey, const std::string& path, double step, double spacing,
              double steps_a_side, const char* advice = "leave such points out with");

/// What a step given by hand does to points; empty where it is fine enough for them.
std::string coarse_step_note(const char* option, const World3& step, double spacing);

}  // namespace pss
