#include "io/points/position_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/points/positions.h"

namespace pss {
namespace {

constexpr std::size_t kBatch = std::size_t{1} << 14;
/// A step by hand is the user's word; from here on it is worth a word of ours.
constexpr double kCoarseStepPerSpacing = 0.1;

bool finite(const World3& p) {
  return std::ranges::all_of(p, [](double v) { return std::isfinite(v); });
}

/// The largest power of ten at or below `value`, to the last digits but one or two of a double.
double round_down(double value) {
  double power = 1;
  while (power * 10 <= value) power *= 10;
  while (power > value) power /= 10;
  return power;
}

/// A box about `middle` with sides of at most `side`, in numbers that are short to read.
WorldBox readable_box(const World3& middle, double side) {
  const double half = round_down(side / 4);
  WorldBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    const double centre = std::nearbyint(middle[a] / half) * half;
    box.min[a] = centre - 2 * half;
    box.max[a] = centre + 2 * half;
  }
  return box;
}

}  // namespace

void PositionSurvey::add(std::size_t input, std::uint64_t record, const World3& position) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (position[a] < bounds_.min[a]) low_[a] = {input, record, position};
    if (position[a] > bounds_.max[a]) high_[a] = {input, record, position};
  }
  bounds_.add(position);
  sample_.add(position);
}

PositionSurvey::Farthest PositionSurvey::farthest() const {
  std::size_t longest = 0;
  const auto side = [&](std::size_t a) { return bounds_.max[a] - bounds_.min[a]; };
  for (std::size_t a = 1; a < 3; ++a)
    if (side(a) > side(longest)) longest = a;
  const double middle = sample_.middle()[longest];
  const bool above = bounds_.max[longest] - middle >= middle - bounds_.min[longest];
  return {above ? high_[longest] : low_[longest], longest};
}

Result<Extent> read_positions(Reader& reader, const std::optional<WorldBox>& kept, Monitor& monitor,
                              const std::function<void(std::uint64_t, const World3&)>& visit) {
  Extent extent;
  PointBatch batch;
  for (;;) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "stopped while reading positions"};
    PSS_TRY(reader.read(kBatch, batch));
    if (batch.size() == 0) return extent;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const World3 position = world_position(batch, reader.header().grid, i);
      if (!finite(position) || (kept && !kept->contains(position))) continue;
      extent.bounds.add(position);
      visit(batch.first_record + i, position);
    }
    extent.records += batch.size();
    monitor.advance(batch.size());
  }
}

Result<void> measure_positions(Reader& reader, const std::optional<WorldBox>& kept,
                               SpacingMeter& meter, Monitor& monitor) {
  std::vector<World3> positions;
  const auto visit = [&](std::uint64_t, const World3& position) {
    positions.push_back(position);
    if (positions.size() < kBatch) return;
    meter.add(positions);
    positions.clear();
  };
  PSS_TRY(read_positions(reader, kept, monitor, visit));
  meter.add(positions);
  return {};
}

Error too_far(const PositionSurvey& survey, const std::string& path, double step, double spacing,
              double steps_a_side, const char* advice) {
  const auto [far, axis] = survey.farthest();
  // Half of what would just do: without the far points the spacing is measured on other ones.
  const WorldBox box =
      readable_box(survey.sample().middle(), 0.5 * kMostStepPerSpacing * spacing * steps_a_side);
  return {Fault::kBadInput,
          fmt::format("{}: record {}: {} = {} is so far from the other points that coordinates "
                      "would get steps of {:.3g}, which is more than a hundredth of the points' "
                      "spacing of {:.3g}; {} "
                      "--drop-outside={:.15g},{:.15g},{:.15g},{:.15g},{:.15g},{:.15g}",
                      path, far.record, "xyz"[axis], far.at[axis], step, spacing, advice,
                      box.min[0], box.min[1], box.min[2], box.max[0], box.max[1], box.max[2])};
}

std::string coarse_step_note(const char* option, const World3& step, double spacing) {
  const double coarsest = *std::ranges::max_element(step);
  if (!(spacing > 0) || coarsest <= kCoarseStepPerSpacing * spacing) return {};
  return fmt::format(
      "{} {}: the step is more than a tenth of the points' spacing of {:.3g}; points "
      "that lie closer together than a step may become one position",
      option, coarsest, spacing);
}

}  // namespace pss
