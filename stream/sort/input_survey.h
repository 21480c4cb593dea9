#pragma once
// All positions of inputs, read before anything is sorted: where they lie, and how far apart.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "io/file/fingerprint.h"
#include "io/points/position_survey.h"
#include "io/watched_reader.h"

namespace pss {

class InputSurvey {
 public:
  /// Positions outside `kept`, which may be absent, are passed over.
  InputSurvey(const std::vector<InputRecord>& inputs, const OpenInput& open,
              const std::optional<WorldBox>& kept, Monitor& monitor)
      : inputs_(inputs), open_(open), kept_(kept), monitor_(monitor) {}

  /// Reads an input whole. `promised` is how many records are expected.
  Result<Extent> measure(std::size_t input, std::uint64_t promised);

  /// Of the inputs that were measured.
  const WorldBox& bounds() const { return survey_.bounds(); }

  /// The spacing of the measured points, as exactly as it takes to compare it with `step`.
  Result<double> spacing_beside(double step) const;

  /// The refusal of a step that is too coarse: see too_far() of io/points/position_survey.h.
  Error too_coarse_step(double step, double spacing, double steps_a_side) const;

 private:
  Result<void> pass_all(SpacingMeter& meter) const;

  const std::vector<InputRecord>& inputs_;
  const OpenInput& open_;
  const std::optional<WorldBox>& kept_;
  Monitor& monitor_;
  PositionSurvey survey_;
};

}  // namespace pss
