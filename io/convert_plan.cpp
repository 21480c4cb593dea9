#include "io/convert_plan.h"

#include <algorithm>
#include <optional>

#include "io/points/common_crs.h"
#include "io/points/integer_grid.h"
#include "io/points/position_survey.h"
#include "io/points/reader.h"

namespace pss {
namespace {

using Readers = std::span<Reader* const>;

Result<void> check_crs(Readers readers) {
  CommonCrs common;
  for (const Reader* reader : readers) PSS_TRY(common.add(reader->header()));
  return {};
}

/// The grid of all readers, where they have the same.
std::optional<Lattice> common_grid(Readers readers) {
  const std::optional<Lattice> first = readers.front()->header().grid;
  for (const Reader* reader : readers)
    if (reader->header().grid != first) return std::nullopt;
  return first;
}

Schema united_schema(Readers readers) {
  Schema schema = readers.front()->header().schema;
  for (const Reader* reader : readers.subspan(1)) schema = unite(schema, reader->header().schema);
  return schema;
}

/// The largest step of the axes along which the points differ.
double coarsest_step(const Lattice& grid, const WorldBox& bounds) {
  double step = 0;
  for (std::size_t a = 0; a < 3; ++a)
    if (bounds.max[a] > bounds.min[a]) step = std::max(step, grid.scale[a]);
  return step;
}

class Planner {
 public:
  Planner(Readers readers, std::optional<Carry> carry, const std::string& output,
          const Format& format, const ConvertOptions& options, Monitor& monitor)
      : readers_(readers), output_(output), format_(format), options_(options), monitor_(monitor) {
    write_.carry = std::move(carry);
  }

  Result<WriteOptions> plan() {
    PSS_TRY(check_crs(readers_));
    write_.schema = united_schema(readers_);
    write_.grid = common_grid(readers_);
    write_.scale = options_.scale;
    write_.offset = options_.offset;
    write_.same_points = readers_.size() == 1 && write_.carry && !options_.scale &&
                         !options_.offset && !options_.drop_outside;
    PSS_TRY(take_bounds());
    if (format_.integer_grid && !write_.same_points) PSS_TRY(check_grid());
    return std::move(write_);
  }

 private:
  /// Count and bounds: as promised, or by reading where nothing is promised.
  Result<void> take_bounds() {
    const bool one_grid = readers_.size() == 1 && write_.grid;
    const bool needs_bounds = format_.integer_grid && !one_grid;
    WorldBox bounds;
    for (std::size_t i = 0; i < readers_.size(); ++i) {
      const CloudHeader& header = readers_[i]->header();
      const bool bounded = !needs_bounds || header.bounds || header.count == std::uint64_t{0};
      if (!header.count || !bounded) {
        PSS_ASSIGN(const std::uint64_t count, survey(i));
        write_.count += count;
        continue;
      }
      write_.count += *header.count;
      promised_ = promised_ || header.count > std::uint64_t{0};
      if (header.bounds) bounds.add(kept(*header.bounds));
    }
    set_bounds(bounds);
    return {};
  }

  WorldBox kept(const WorldBox& bounds) const {
    return options_.drop_outside ? bounds.clipped(*options_.drop_outside) : bounds;
  }

  void set_bounds(WorldBox bounds) {
    bounds.add(survey_.bounds());
    write_.bounds = bounds.empty() ? std::nullopt : std::optional(bounds);
  }

  /// Reads all positions of one reader, and returns it to its start.
  Result<std::uint64_t> survey(std::size_t number) {
    if (!begun_) monitor_.begin("survey", 0);
    begun_ = true;
    Reader& reader = *readers_[number];
    PSS_ASSIGN(const Extent extent, read_positions(reader, options_.drop_outside, monitor_,
                                                   [&](std::uint64_t record, const World3& at) {
                                                     survey_.add(number, record, at);
                                                   }));
    PSS_TRY(reader.seek(0));
    return extent.records;
  }

  /// Reads all positions of all readers: what headers promise is trusted no more.
  Result<void> survey_all() {
    survey_ = {};
    promised_ = false;
    for (std::size_t i = 0; i < readers_.size(); ++i) PSS_TRY(survey(i));
    set_bounds({});
    return {};
  }

  /// Refuses a grid that the points do not fit, and a chosen one that is too coarse for them.
  Result<void> check_grid() {
    if (!write_.bounds) return {};
    PSS_ASSIGN(Lattice grid, planned_grid());
    if (promised_ && !surely_good(grid)) {
      PSS_TRY(survey_all());
      if (!write_.bounds) return {};
      PSS_ASSIGN(grid, planned_grid());
    }
    const bool one = readers_.size() == 1;
    PSS_TRY(check_integer_grid(one ? readers_[0]->header().path : output_, grid, *write_.bounds,
                               *write_.bounds));
    return promised_ || !chosen(grid) ? Result<void>() : check_step(grid);
  }

  /// The grid that the writer makes of what is known.
  Result<Lattice> planned_grid() const {
    PSS_ASSIGN(const std::optional<Lattice> grid, format_.plan(output_, write_));
    return *grid;
  }

  /// Whether the scale is neither by hand nor that of an input.
  bool chosen(const Lattice& grid) const {
    return !options_.scale && std::ranges::none_of(readers_, [&](const Reader* reader) {
      const std::optional<Lattice>& own = reader->header().grid;
      return own && own->scale == grid.scale;
    });
  }

  /// By what headers promise: a grid that is chosen for that alone may be far too coarse.
  bool surely_good(const Lattice& grid) const {
    return integer_grid_holds(grid, *write_.bounds) && !chosen(grid);
  }

  Result<void> check_step(const Lattice& grid) {
    const double step = coarsest_step(grid, *write_.bounds);
    PSS_ASSIGN(const double spacing,
               spacing_beside(step, survey_.sample(),
                              [this](SpacingMeter& meter) { return measure_spacing(meter); }));
    if (!too_coarse(step, spacing)) return {};
    const std::size_t culprit = survey_.farthest().position.input;
    return too_far(survey_, readers_[culprit]->header().path, step, spacing, kLeastGridSteps);
  }

  Result<void> measure_spacing(SpacingMeter& meter) {
    for (Reader* reader : readers_) {
      PSS_TRY(measure_positions(*reader, options_.drop_outside, meter, monitor_));
      PSS_TRY(reader->seek(0));
    }
    return {};
  }

  Readers readers_;
  const std::string& output_;
  const Format& format_;
  const ConvertOptions& options_;
  Monitor& monitor_;
  WriteOptions write_;
  PositionSurvey survey_;
  bool promised_ = false;  ///< some bounds are what a header says
  bool begun_ = false;
};

}  // namespace

std::optional<Carry> carry_for(Readers readers, const Format& format) {
  for (const Reader* reader : readers) {
    const Carry& carry = reader->header().carry;
    if (carry.family == format.family && !carry.head.empty()) return carry;
  }
  return std::nullopt;
}

Result<WriteOptions> plan_conversion(Readers readers, std::optional<Carry> carry,
                                     const std::string& output, const Format& format,
                                     const ConvertOptions& options, Monitor& monitor) {
  return Planner(readers, std::move(carry), output, format, options, monitor).plan();
}

}  // namespace pss
