#include "stream/sort/input_survey.h"

#include <memory>

namespace pss {

Result<Extent> InputSurvey::measure(std::size_t input, std::uint64_t promised) {
  monitor_.begin("bounds", promised);
  PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_(inputs_[input], HeadBytes::kLeft, {}));
  return read_positions(*reader, kept_, monitor_, [&](std::uint64_t record, const World3& at) {
    survey_.add(input, record, at);
  });
}

Result<double> InputSurvey::spacing_beside(double step) const {
  return pss::spacing_beside(step, survey_.sample(),
                             [this](SpacingMeter& meter) { return pass_all(meter); });
}

Result<void> InputSurvey::pass_all(SpacingMeter& meter) const {
  monitor_.begin("spacing", 0);
  for (const InputRecord& record : inputs_) {
    PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_(record, HeadBytes::kLeft, {}));
    PSS_TRY(measure_positions(*reader, kept_, meter, monitor_));
  }
  return {};
}

Error InputSurvey::too_coarse_step(double step, double spacing, double steps_a_side) const {
  return too_far(survey_, inputs_[survey_.farthest().position.input].path, step, spacing,
                 steps_a_side);
}

}  // namespace pss
