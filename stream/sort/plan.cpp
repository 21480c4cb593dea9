// plan_ingest() of stream/sort/ingest.h: what of the inputs decides the store.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "io/file/fingerprint.h"
#include "io/points/common_crs.h"
#include "io/points/integer_grid.h"
#include "stream/sort/common_lattice.h"
#include "stream/sort/ingest.h"
#include "stream/sort/ingest_memory.h"
#include "stream/sort/input_stream.h"
#include "stream/sort/input_survey.h"
#include "stream/sort/placement.h"

namespace pss {
namespace {

/// So many steps a side of the bounds has at least on the lattice that is chosen for them.
constexpr double kLeastLatticeSteps = 0x1p40;

double coarsest_step(const Lattice& grid) { return *std::ranges::max_element(grid.scale); }

/// What is kept of an input's header: there may be very many.
struct Input {
  const InputRecord& record;
  std::optional<Lattice> grid;
  std::optional<WorldBox> promised;  ///< bounds by the header
  std::optional<WorldBox> measured;  ///< after a pass over all positions
  std::uint64_t count = 0;
};

class Planner {
 public:
  Planner(std::vector<InputRecord> inputs, const IngestOptions& options, Monitor& monitor)
      : options_(options),
        monitor_(monitor),
        survey_(plan_.inputs, options.open, options.drop_outside, monitor) {
    plan_.open = options.open;
    plan_.header.inputs = digest_of(inputs);
    plan_.inputs = std::move(inputs);
  }

  Result<IngestPlan> plan() {
    if (options_.tile_points == 0)
      return Error{Fault::kUsage, "--tile-points 0: a tile has at least one point"};
    if (options_.scale) PSS_TRY(check_step(*options_.scale));
    PSS_TRY(open_inputs());
    PSS_TRY(complete_schema());
    PSS_TRY(choose_lattice());
    note_moves();
    return result();
  }

 private:
  Result<void> open_inputs() {
    plan_.header.tile_points = options_.tile_points;
    plan_.drop_outside = options_.drop_outside;
    if (options_.drop_outside)
      plan_.header.parameters =
          fmt::format(R"({{"drop-outside":[{},{}]}})", fmt::join(options_.drop_outside->min, ","),
                      fmt::join(options_.drop_outside->max, ","));
    CommonCrs crs;
    for (const InputRecord& record : plan_.inputs) {
      if (monitor_.stopping()) return Error{Fault::kInterrupted, "stopped while reading headers"};
      PSS_ASSIGN(const auto reader, options_.open(record, HeadBytes::kLeft, {}));
      PSS_TRY(crs.add(reader->header()));
      PSS_TRY(take_unit(*reader));
      take(record, reader->header());
    }
    return {};
  }

  void take(const InputRecord& record, const CloudHeader& header) {
    if (inputs_.empty()) {
      plan_.header.schema = header.schema;
    } else if (header.schema != last_schema_) {
      plan_.header.schema = unite(plan_.header.schema, header.schema);
    }
    last_schema_ = header.schema;
    plan_.head_sizes.push_back(header.carry_size + header.crs.size());
    inputs_.push_back({record, header.grid, kept(header.bounds), {}, header.count.value_or(0)});
    for (const std::string& warning : header.warnings)
      plan_.notes.push_back(fmt::format("{}: {}", record.path, warning));
  }

  Result<void> take_unit(const Reader& reader) {
    plan_.unit = std::max(plan_.unit, reader.unit());
    if (reader.unit() <= kLargestUnit) return {};
    return Error{Fault::kBadInput,
                 fmt::format("{}: found {} records that are compressed together, expected at most "
                             "{}; write the file anew with fewer",
                             reader.header().path, reader.unit(), kLargestUnit)};
  }

  /// What the points that are kept can reach of `bounds`.
  std::optional<WorldBox> kept(const std::optional<WorldBox>& bounds) const {
    return bounds && options_.drop_outside ? bounds->clipped(*options_.drop_outside) : bounds;
  }

  Result<void> complete_schema() {
    Schema& schema = plan_.header.schema;
    if (options_.source_column) PSS_TRY(add_source_column(schema));
    if (schema.row_size() <= kMaxRowSize) return {};
    return Error{Fault::kBadInput,
                 fmt::format("{}: points with {} bytes of attributes found, {} are supported",
                             plan_.inputs[0].path, schema.row_size(), kMaxRowSize)};
  }

  Result<void> add_source_column(Schema& schema) const {
    for (const char* name : {kSourceFile, kSourceRecord})
      if (schema.dimension(name))
        return Error{Fault::kBadInput,
                     fmt::format("the inputs have an attribute {} already, which is the name of "
                                 "the source column",
                                 name)};
    schema.add({kSourceFile, Type::kUint32, 1, 1, 0, {}});
    schema.add({kSourceRecord, Type::kUint64, 1, 1, 0, {}});
    return {};
  }

  bool all_on_grids() const {
    return std::ranges::all_of(inputs_, [](const Input& i) { return i.grid.has_value(); });
  }

  Result<void> choose_lattice() {
    if (inputs_.empty()) return {};
    return all_on_grids() ? lattice_of_grids() : lattice_of_bounds();
  }

  Result<void> lattice_of_grids() {
    std::vector<Lattice> grids;
    for (const Input& input : inputs_) grids.push_back(*input.grid);
    Lattice lattice = common_grid(grids);
    if (options_.scale) lattice.scale = *options_.scale;
    plan_.header.lattice = lattice;
    plan_.header.grid = lattice;
    // What a header promises is not trusted, least of all to refuse a file.
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      const Input& input = inputs_[i];
      if (input.promised && check_places(input.record.path, *input.promised)) continue;
      PSS_TRY(measure_one(i));
      PSS_TRY(check_places(input.record.path, *input.measured));
    }
    const auto& output = options_.gridded_output;
    return output && chooses_scale(plan_.header, *output) ? check_chosen_scale() : Result<void>();
  }

  /// The output gets the finest scale that holds the points, instead of that of the inputs.
  Result<void> check_chosen_scale() {
    for (std::size_t i = 0; i < inputs_.size(); ++i)
      if (!inputs_[i].measured) PSS_TRY(measure_one(i));
    return survey_.bounds().empty() ? Result<void>() : check_steps(0);
  }

  /// Whether positions within `bounds` have a place on the lattice, and in the output.
  Result<void> check_places(const std::string& path, const WorldBox& bounds) const {
    PSS_TRY(check_fits(path, bounds, plan_.header.lattice));
    if (!options_.gridded_output) return {};
    const WorldBox all = all_bounds();
    return check_integer_grid(path, output_grid(all), bounds, all);
  }

  /// Requires: a gridded output.
  Lattice output_grid(const WorldBox& bounds) const {
    return export_grid(plan_.header, bounds, 0, *options_.gridded_output);
  }

  /// Of all inputs, as far as they are known.
  WorldBox all_bounds() const {
    WorldBox all;
    for (const Input& input : inputs_)
      all.add(input.measured ? *input.measured : input.promised.value_or(WorldBox()));
    return all;
  }

  Result<void> measure_one(std::size_t number) {
    Input& input = inputs_[number];
    PSS_ASSIGN(const Extent found, survey_.measure(number, input.count));
    input.count = found.records;
    input.measured = found.bounds;
    return {};
  }

  /// The lattice is as fine as the bounds allow, so a single far point makes it coarse for all: no
  /// point may be rounded by more than a small share of the way to its neighbours.
  Result<void> check_steps(double step) {
    const bool scale_chosen =
        options_.gridded_output && chooses_scale(plan_.header, *options_.gridded_output);
    if (scale_chosen) step = std::max(step, coarsest_step(output_grid(survey_.bounds())));
    PSS_ASSIGN(plan_.spacing, survey_.spacing_beside(step));
    if (options_.scale) return note_coarse_scale();
    if (!too_coarse(step, plan_.spacing)) return {};
    return survey_.too_coarse_step(step, plan_.spacing,
                                   scale_chosen ? kLeastGridSteps : kLeastLatticeSteps);
  }

  Result<void> note_coarse_scale() {
    std::string note = coarse_step_note("--scale", *options_.scale, plan_.spacing);
    if (!note.empty()) plan_.notes.push_back(std::move(note));
    return {};
  }

  Result<void> lattice_of_bounds() {
    for (std::size_t i = 0; i < inputs_.size(); ++i) PSS_TRY(measure_one(i));
    const WorldBox& bounds = survey_.bounds();
    for (std::size_t a = 0; a < 3 && !bounds.empty(); ++a)
      if (!std::isfinite(bounds.max[a] - bounds.min[a])) return beyond_any_lattice(a);
    plan_.header.lattice =
        options_.scale ? lattice_with_step(bounds, *options_.scale) : lattice_for(bounds);
    if (options_.scale) plan_.header.grid = plan_.header.lattice;
    for (const Input& input : inputs_) PSS_TRY(check_places(input.record.path, *input.measured));
    if (bounds.empty()) return {};
    return check_steps(coarsest_step(plan_.header.lattice));
  }

  Result<void> beyond_any_lattice(std::size_t axis) {
    PSS_TRY(check_steps(std::numeric_limits<double>::infinity()));
    return Error{
        Fault::kBadInput,
        fmt::format("{}: positions from {} to {} are too far apart for any lattice; leave "
                    "some out with --drop-outside",
                    plan_.inputs[0].path, survey_.bounds().min[axis], survey_.bounds().max[axis])};
  }

  void note_moves() {
    for (const Input& input : inputs_) {
      if (!input.grid || align(*input.grid, plan_.header.lattice)) continue;
      const World3& step = plan_.header.lattice.scale;
      plan_.notes.push_back(
          fmt::format("{}: its grid does not align with the common lattice; its points move by at "
                      "most half a step ({}, {}, {})",
                      input.record.path, step[0] / 2, step[1] / 2, step[2] / 2));
    }
  }

  IngestPlan result() {
    for (const Input& input : inputs_) {
      plan_.counts.push_back(input.count);
      plan_.points += input.count;
    }
    return std::move(plan_);
  }

  const IngestOptions& options_;
  Monitor& monitor_;
  IngestPlan plan_;
  std::vector<Input> inputs_;
  InputSurvey survey_;  ///< of the inputs whose positions were all read
  Schema last_schema_;
};

}  // namespace

Result<IngestPlan> plan_ingest(std::vector<InputRecord> inputs, const IngestOptions& options,
                               Monitor& monitor) {
  return Planner(std::move(inputs), options, monitor).plan();
}

Result<IngestPlan> plan_ingest(const std::vector<std::string>& inputs, const IngestOptions& options,
                               Monitor& monitor) {
  std::vector<InputRecord> records;
  for (const std::string& path : inputs) {
    PSS_ASSIGN(InputRecord record, settled_fingerprint(path));
    records.push_back(std::move(record));
  }
  return plan_ingest(std::move(records), options, monitor);
}

}  // namespace pss
