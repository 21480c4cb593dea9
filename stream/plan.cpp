// plan_ingest() of stream/ingest.h: what of the inputs decides the store.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "io/fingerprint.h"
#include "stream/common_lattice.h"
#include "stream/ingest.h"
#include "stream/input_stream.h"
#include "stream/placement.h"

namespace pss {
namespace {

constexpr std::size_t kBatch = 1 << 14;

/// What is kept of an input's header: there may be very many.
struct Input {
  const std::string& path;
  std::optional<Lattice> grid;
  std::optional<WorldBox> promised;  ///< bounds by the header
  std::optional<WorldBox> measured;  ///< after a pass over all positions
  std::uint64_t count = 0;
};

bool finite(const World3& p) {
  return std::ranges::all_of(p, [](double v) { return std::isfinite(v); });
}

/// Bounds and number of the points of a file, by reading them all.
Result<void> measure(Input& input, Monitor& monitor) {
  PSS_ASSIGN(const auto reader, open_reader(input.path));
  WorldBox bounds;
  PointBatch batch;
  input.count = 0;
  for (;;) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "stopped while measuring bounds"};
    PSS_TRY(reader->read(kBatch, batch));
    if (batch.size() == 0) break;
    for (const Index3& p : batch.index) bounds.add(to_world(*reader->header().grid, p));
    for (const World3& p : batch.world)
      if (finite(p)) bounds.add(p);
    input.count += batch.size();
    monitor.advance(batch.size());
  }
  input.measured = bounds;
  return {};
}

class Planner {
 public:
  Planner(const std::vector<std::string>& paths, const IngestOptions& options, Monitor& monitor)
      : paths_(paths), options_(options), monitor_(monitor) {}

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
    plan_.inputs = paths_;
    plan_.header.tile_points = options_.tile_points;
    for (const std::string& path : paths_) {
      if (monitor_.stopping()) return Error{Fault::kInterrupted, "stopped while reading headers"};
      PSS_ASSIGN(const auto reader, open_reader(path));
      PSS_TRY(check_crs(reader->header()));
      PSS_ASSIGN(InputRecord record, fingerprint(path));
      plan_.header.inputs.push_back(std::move(record));
      take(path, reader->header());
    }
    return {};
  }

  void take(const std::string& path, const CloudHeader& header) {
    if (inputs_.empty()) {
      plan_.header.carry = header.carry;
      plan_.header.source_format = header.format;
      plan_.header.schema = header.schema;
    } else if (header.schema != last_schema_) {
      plan_.header.schema = unite(plan_.header.schema, header.schema);
    }
    last_schema_ = header.schema;
    inputs_.push_back({path, header.grid, header.bounds, {}, header.count.value_or(0)});
    for (const std::string& warning : header.warnings)
      plan_.notes.push_back(fmt::format("{}: {}", path, warning));
  }

  Result<void> check_crs(const CloudHeader& header) {
    if (header.crs.empty() || header.crs == plan_.header.crs) return {};
    if (plan_.header.crs.empty()) {
      plan_.header.crs = header.crs;
      crs_path_ = header.path;
      return {};
    }
    return Error{Fault::kBadInput,
                 fmt::format("{} and {}: their coordinate reference systems differ; bring them "
                             "into one first",
                             crs_path_, header.path)};
  }

  Result<void> complete_schema() {
    Schema& schema = plan_.header.schema;
    if (options_.source_column) PSS_TRY(add_source_column(schema));
    if (schema.row_size() <= kMaxRowSize) return {};
    return Error{Fault::kBadInput,
                 fmt::format("{}: points with {} bytes of attributes found, {} are supported",
                             paths_[0], schema.row_size(), kMaxRowSize)};
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
    // What a header promises is not trusted, least of all to refuse a file.
    for (Input& input : inputs_) {
      if (input.promised && check_fits(input.path, *input.promised, lattice)) continue;
      PSS_TRY(measure_one(input));
      PSS_TRY(check_fits(input.path, *input.measured, lattice));
    }
    plan_.header.lattice = lattice;
    plan_.header.grid = lattice;
    return {};
  }

  Result<void> measure_one(Input& input) {
    monitor_.begin("bounds", input.count);
    return measure(input, monitor_);
  }

  Result<void> lattice_of_bounds() {
    WorldBox bounds;
    for (Input& input : inputs_) {
      PSS_TRY(measure_one(input));
      bounds.add(*input.measured);
    }
    for (std::size_t a = 0; a < 3 && !bounds.empty(); ++a)
      if (!std::isfinite(bounds.max[a] - bounds.min[a]))
        return Error{Fault::kBadInput, fmt::format("{}: positions from {} to {} are too far apart "
                                                   "for any lattice",
                                                   paths_[0], bounds.min[a], bounds.max[a])};
    plan_.header.lattice =
        options_.scale ? lattice_with_step(bounds, *options_.scale) : lattice_for(bounds);
    if (options_.scale) plan_.header.grid = plan_.header.lattice;
    for (const Input& input : inputs_)
      PSS_TRY(check_fits(input.path, *input.measured, plan_.header.lattice));
    return {};
  }

  void note_moves() {
    for (const Input& input : inputs_) {
      if (!input.grid || align(*input.grid, plan_.header.lattice)) continue;
      const World3& step = plan_.header.lattice.scale;
      plan_.notes.push_back(
          fmt::format("{}: its grid does not align with the common lattice; its points move by at "
                      "most half a step ({}, {}, {})",
                      input.path, step[0] / 2, step[1] / 2, step[2] / 2));
    }
  }

  IngestPlan result() {
    for (const Input& input : inputs_) {
      plan_.counts.push_back(input.count);
      plan_.points += input.count;
    }
    return std::move(plan_);
  }

  const std::vector<std::string>& paths_;
  const IngestOptions& options_;
  Monitor& monitor_;
  IngestPlan plan_;
  std::vector<Input> inputs_;
  Schema last_schema_;
  std::string crs_path_;
};

}  // namespace

Result<IngestPlan> plan_ingest(const std::vector<std::string>& inputs, const IngestOptions& options,
                               Monitor& monitor) {
  return Planner(inputs, options, monitor).plan();
}

}  // namespace pss
