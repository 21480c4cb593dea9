#include "io/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "io/inputs.h"
#include "io/reader_on_demand.h"
#include "io/writer.h"

namespace pss {
namespace {

constexpr std::size_t kBatch = std::size_t{1} << 16;
constexpr const char* kNotFinite = "position is not finite";

using Readers = std::span<Reader* const>;

bool finite(const World3& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

Error interrupted() { return {Fault::kInterrupted, "interrupted; nothing was written"}; }

/// Enough of a text to tell it from another.
std::string shortened(const std::string& text) {
  constexpr std::size_t kLongest = 160;
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

Result<void> check_crs(Readers readers) {
  const CloudHeader* named = nullptr;
  for (const Reader* reader : readers) {
    const CloudHeader& header = reader->header();
    if (header.crs.empty()) continue;
    if (named && named->crs != header.crs)
      return Error{
          Fault::kBadInput,
          fmt::format("{}: found the coordinate system {}, expected {} as in {}; bring "
                      "the files into one system first",
                      header.path, shortened(header.crs), shortened(named->crs), named->path)};
    if (!named) named = &header;
  }
  return {};
}

/// What must be read to be known: how many points there are, and where.
struct Survey {
  std::uint64_t count = 0;
  WorldBox bounds;
};

/// Adds what a whole reading shows of one reader, and returns it to its start.
Result<void> survey_points(Reader& reader, Survey& survey, Monitor& monitor) {
  PointBatch batch;
  do {
    if (monitor.stopping()) return interrupted();
    PSS_TRY(reader.read(kBatch, batch));
    survey.count += batch.size();
    for (const World3& p : batch.world)
      if (finite(p)) survey.bounds.add(p);
    for (const Index3& i : batch.index) survey.bounds.add(to_world(*reader.header().grid, i));
    monitor.advance(batch.size());
  } while (batch.size() > 0);
  return reader.seek(0);
}

Result<Survey> survey(Readers readers, bool needs_bounds, Monitor& monitor) {
  Survey result;
  bool begun = false;
  for (Reader* reader : readers) {
    const CloudHeader& header = reader->header();
    const bool bounded = !needs_bounds || header.bounds || header.count == std::uint64_t{0};
    if (header.count && bounded) {
      result.count += *header.count;
      if (header.bounds) result.bounds.add(*header.bounds);
      continue;
    }
    if (!begun) monitor.begin("survey", 0);
    begun = true;
    PSS_TRY(survey_points(*reader, result, monitor));
  }
  return result;
}

/// The grid of all readers, where they have the same.
std::optional<Lattice> common_grid(Readers readers) {
  const std::optional<Lattice> first = readers.front()->header().grid;
  for (const Reader* reader : readers)
    if (reader->header().grid != first) return std::nullopt;
  return first;
}

std::optional<Carry> carry_for(Readers readers, Format format) {
  for (const Reader* reader : readers) {
    const Carry& carry = reader->header().carry;
    if (carry.format == format && !carry.head.empty()) return carry;
  }
  return std::nullopt;
}

Schema united_schema(Readers readers) {
  Schema schema = readers.front()->header().schema;
  for (const Reader* reader : readers.subspan(1)) schema = unite(schema, reader->header().schema);
  return schema;
}

/// Brings batches of one reader into the form that the writer was promised.
class Adapter {
 public:
  Adapter(const Reader& reader, const Schema& schema, const std::optional<Lattice>& grid,
          bool keep_not_finite)
      : mapper_(reader.header().schema, schema),
        from_size_(reader.header().schema.row_size()),
        to_size_(schema.row_size()),
        grid_(reader.header().grid),
        to_world_(reader.header().grid != grid),
        keep_not_finite_(keep_not_finite) {}

  /// Returns the points that were dropped.
  std::uint64_t adapt(PointBatch& batch) {
    if (to_world_) {
      for (const Index3& i : batch.index) batch.world.push_back(to_world(*grid_, i));
      batch.index.clear();
    }
    const std::size_t before = batch.size();
    if (!keep_not_finite_) drop_not_finite(batch);
    if (!mapper_.identity()) {
      rows_.resize(batch.size() * to_size_);
      mapper_.map(batch.rows, rows_);
      std::swap(batch.rows, rows_);
    }
    return before - batch.size();
  }

 private:
  void drop_not_finite(PointBatch& batch) const {
    if (std::ranges::all_of(batch.world, finite)) return;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < batch.world.size(); ++i) {
      if (!finite(batch.world[i])) continue;
      batch.world[kept] = batch.world[i];
      const auto row = batch.rows.begin() + static_cast<std::ptrdiff_t>(i * from_size_);
      std::copy_n(row, from_size_,
                  batch.rows.begin() + static_cast<std::ptrdiff_t>(kept * from_size_));
      ++kept;
    }
    batch.world.resize(kept);
    batch.rows.resize(kept * from_size_);
  }

  RowMapper mapper_;
  std::size_t from_size_, to_size_;
  std::optional<Lattice> grid_;
  bool to_world_ = false;
  bool keep_not_finite_ = false;
  std::vector<std::byte> rows_;
};

Result<void> copy(Reader& reader, Adapter adapter, Writer& writer, ConvertSummary& summary,
                  Monitor& monitor) {
  PointBatch batch;
  for (;;) {
    if (monitor.stopping()) return interrupted();
    PSS_TRY(reader.read(kBatch, batch));
    const std::size_t count = batch.size();
    if (count == 0) return {};
    const std::uint64_t dropped = adapter.adapt(batch);
    PSS_TRY(writer.write(batch));
    summary.points_in += count;
    summary.points_out += batch.size();
    if (dropped > 0) summary.dropped[kNotFinite] += dropped;
    monitor.advance(count);
  }
}

Result<WriteOptions> plan(Readers readers, const std::string& output, const ConvertOptions& options,
                          Monitor& monitor) {
  WriteOptions plan;
  PSS_ASSIGN(plan.format, format_for(output));
  PSS_TRY(check_crs(readers));
  plan.schema = united_schema(readers);
  plan.grid = common_grid(readers);
  plan.carry = carry_for(readers, plan.format);
  const bool one_grid = readers.size() == 1 && plan.grid;
  const bool needs_bounds = plan.format == Format::kLas && !one_grid;
  PSS_ASSIGN(const Survey found, survey(readers, needs_bounds, monitor));
  plan.count = found.count;
  if (!found.bounds.empty()) plan.bounds = found.bounds;
  plan.scale = options.scale;
  plan.offset = options.offset;
  plan.same_points = readers.size() == 1 && plan.carry && !options.scale && !options.offset;
  return plan;
}

void note_inputs(Readers readers, const std::optional<Carry>& carry,
                 std::vector<std::string>& notes) {
  for (const Reader* reader : readers)
    for (const std::string& warning : reader->header().warnings)
      notes.push_back(fmt::format("{}: {}", reader->header().path, warning));
  if (readers.size() > 1 && carry)
    notes.push_back("the header is that of the first input of the output's format");
}

}  // namespace

Result<ConvertSummary> copy_points(Readers readers, const std::string& output,
                                   const ConvertOptions& options, Monitor& monitor) {
  if (readers.empty()) return Error{Fault::kFailed, "no input: there is nothing to convert"};
  PSS_TRY(check_replaceable(output, options.overwrite));
  PSS_ASSIGN(const OutputLock lock, OutputLock::take(output));
  PSS_ASSIGN(WriteOptions planned, plan(readers, output, options, monitor));
  planned.rules = {options.overwrite, &lock, {}};
  PSS_ASSIGN(const std::unique_ptr<Writer> writer, create_writer(output, planned));
  ConvertSummary summary;
  note_inputs(readers, planned.carry, summary.notes);
  monitor.begin("convert", planned.count);
  for (Reader* reader : readers) {
    Adapter adapter(*reader, planned.schema, planned.grid, planned.format != Format::kLas);
    PSS_TRY(copy(*reader, std::move(adapter), *writer, summary, monitor));
  }
  PSS_TRY(writer->finish());
  const auto& written = writer->notes();
  summary.notes.insert(summary.notes.end(), written.begin(), written.end());
  return summary;
}

Result<ConvertSummary> convert(const std::vector<std::string>& inputs, const std::string& output,
                               const ConvertOptions& options, Monitor& monitor) {
  PSS_ASSIGN(const Format format, format_for(output));
  PSS_TRY(
      check_grid_options(output, format, options.scale.has_value(), options.offset.has_value()));
  PSS_TRY(check_files(inputs));
  PSS_TRY(check_output(inputs, output));
  std::vector<std::unique_ptr<Reader>> owned;
  std::vector<Reader*> readers;
  bool carried = false;
  for (const std::string& input : inputs) {
    PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_reader(input));
    CloudHeader header = reader->header();
    if (carried) header.carry = {};  // only the first of the format is used, and thousands add up
    carried = carried || (header.carry.format == format && !header.carry.head.empty());
    owned.push_back(std::make_unique<ReaderOnDemand>(std::move(header)));
    readers.push_back(owned.back().get());
  }
  return copy_points(readers, output, options, monitor);
}

}  // namespace pss
