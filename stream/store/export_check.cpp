// check_export() of stream/store/export.h: what a file of a store could not hold.

#include <algorithm>

#include "io/points/integer_grid.h"
#include "io/points/position_survey.h"
#include "stream/store/export.h"

namespace pss {
namespace {

using VisitPositions = std::function<Result<void>(std::uint64_t row, std::span<const World3>)>;

/// Reads the positions of all blocks.
Result<void> visit_blocks(const Store& store, const Monitor& monitor, const VisitPositions& visit) {
  std::vector<Index3> indices;
  std::vector<World3> positions;
  for (std::size_t t = 0; t < store.tiles().size(); ++t) {
    const TileInfo& tile = store.tiles()[t];
    PSS_ASSIGN(const std::vector<BlockInfo> index, store.read_index(t));
    for (const BlockInfo& block : index) {
      if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
      indices.resize(block.count);
      positions.resize(block.count);
      PSS_TRY(store.read_positions(tile, block, indices));
      std::ranges::transform(indices, positions.begin(),
                             [&](const Index3& i) { return to_world(store.header().lattice, i); });
      PSS_TRY(visit(block.first_row, positions));
    }
  }
  return {};
}

WorldBox widened(WorldBox bounds, double room) {
  for (std::size_t a = 0; a < 3 && !bounds.empty(); ++a) {
    bounds.min[a] -= room;
    bounds.max[a] += room;
  }
  return bounds;
}

Result<PositionSurvey> survey_rows(const Store& store, const Monitor& monitor) {
  PositionSurvey survey;
  PSS_TRY(visit_blocks(store, monitor,
                       [&](std::uint64_t row, std::span<const World3> positions) -> Result<void> {
                         for (const World3& position : positions) survey.add(0, row++, position);
                         return {};
                       }));
  return survey;
}

Result<double> spacing_of_rows(const Store& store, double step, const PositionSurvey& survey,
                               const Monitor& monitor) {
  return spacing_beside(step, survey.sample(), [&](SpacingMeter& meter) {
    return visit_blocks(store, monitor, [&](std::uint64_t, std::span<const World3> positions) {
      meter.add(positions);
      return Result<void>();
    });
  });
}

}  // namespace

Result<void> check_export_box(const Store& store, double margin, const Format& format,
                              const ExportOptions& options) {
  if (!format.integer_grid) return {};
  const WorldBox bounds = world_bounds_of(store);
  const Lattice grid = export_grid(store.header(), bounds, margin, options);
  return check_integer_grid(store.path(), grid, bounds, widened(bounds, margin));
}

Result<std::string> check_export(const Store& store, double margin, const Format& format,
                                 const ExportOptions& options, Monitor& monitor,
                                 const char* advice) {
  if (!format.integer_grid) return std::string();
  const StoreHeader& header = store.header();
  const WorldBox bounds = world_bounds_of(store);
  const Lattice grid = export_grid(header, bounds, margin, options);
  PSS_TRY(check_export_box(store, margin, format, options));
  const bool chosen = chooses_scale(header, options);
  if (bounds.empty() || (!chosen && !options.scale)) return std::string();
  const double step = *std::ranges::max_element(grid.scale);
  PSS_ASSIGN(const PositionSurvey survey, survey_rows(store, monitor));
  PSS_ASSIGN(const double spacing, spacing_of_rows(store, step, survey, monitor));
  if (!chosen) return coarse_step_note("--scale", grid.scale, spacing);
  if (!too_coarse(step, spacing)) return std::string();
  return too_far(survey, store.path(), step, spacing, kLeastGridSteps, advice);
}

}  // namespace pss
