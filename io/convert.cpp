#include "io/convert.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "io/convert_plan.h"
#include "io/inputs.h"
#include "io/open.h"
#include "io/points/position_survey.h"
#include "io/points/positions.h"
#include "io/reader_on_demand.h"

namespace pss {
namespace {

constexpr std::size_t kBatch = std::size_t{1} << 16;
constexpr const char* kNotFinite = "position is not finite";
constexpr const char* kOutside = "position is outside the box of --drop-outside";

using Readers = std::span<Reader* const>;

bool finite(const World3& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

Error interrupted() { return {Fault::kInterrupted, "interrupted; nothing was written"}; }

/// Brings batches of one reader into the form that the writer was promised.
class Adapter {
 public:
  Adapter(const Reader& reader, const WriteOptions& planned, const Format& format,
          const std::optional<WorldBox>& kept)
      : mapper_(reader.header().schema, planned.schema),
        from_size_(reader.header().schema.row_size()),
        to_size_(planned.schema.row_size()),
        grid_(reader.header().grid),
        to_world_(reader.header().grid != planned.grid),
        keep_not_finite_(!format.integer_grid),
        kept_(kept) {}

  /// Adds the points that are dropped to `dropped`, by reason.
  void adapt(PointBatch& batch, std::map<std::string, std::uint64_t>& dropped) {
    drop(batch, dropped);
    if (to_world_) {
      for (const Index3& i : batch.index) batch.world.push_back(to_world(*grid_, i));
      batch.index.clear();
    }
    if (!mapper_.identity()) {
      rows_.resize(batch.size() * to_size_);
      mapper_.map(batch.rows, rows_);
      std::swap(batch.rows, rows_);
    }
  }

  /// The grid of an adapted batch's positions.
  const std::optional<Lattice>& grid() const { return grid_; }

 private:
  /// Why a point is left out; null for one that stays.
  const char* reason(const World3& position) const {
    if (!finite(position)) return keep_not_finite_ ? nullptr : kNotFinite;
    return kept_ && !kept_->contains(position) ? kOutside : nullptr;
  }

  void drop(PointBatch& batch, std::map<std::string, std::uint64_t>& dropped) const {
    const bool on_grid = !batch.index.empty();
    if (on_grid && !kept_) return;
    std::size_t to = 0;
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (const char* why = reason(world_position(batch, grid_, i)))
        ++dropped[why];
      else
        move_point(batch, i, to++);
    }
    on_grid ? batch.index.resize(to) : batch.world.resize(to);
    batch.rows.resize(to * from_size_);
  }

  void move_point(PointBatch& batch, std::size_t from, std::size_t to) const {
    if (from == to) return;
    if (batch.index.empty())
      batch.world[to] = batch.world[from];
    else
      batch.index[to] = batch.index[from];
    const auto row = batch.rows.begin() + static_cast<std::ptrdiff_t>(from * from_size_);
    std::copy_n(row, from_size_, batch.rows.begin() + static_cast<std::ptrdiff_t>(to * from_size_));
  }

  RowMapper mapper_;
  std::size_t from_size_, to_size_;
  std::optional<Lattice> grid_;
  bool to_world_ = false;
  bool keep_not_finite_ = false;
  std::optional<WorldBox> kept_;
  std::vector<std::byte> rows_;
};

/// Samples the positions that the writer rounds.
void sample_rounded(const PointBatch& batch, const std::optional<Lattice>& from,
                    const Writer& writer, WorldSample& sample) {
  if (!writer.grid() || (!batch.index.empty() && from == writer.grid())) return;
  for (std::size_t i = 0; i < batch.size(); ++i) sample.add(world_position(batch, from, i));
}

Result<void> copy(Reader& reader, Adapter adapter, Writer& writer, WorldSample& rounded,
                  ConvertSummary& summary, Monitor& monitor) {
  PointBatch batch;
  for (;;) {
    if (monitor.stopping()) return interrupted();
    PSS_TRY(reader.read(kBatch, batch));
    const std::size_t count = batch.size();
    if (count == 0) return {};
    adapter.adapt(batch, summary.dropped);
    PSS_TRY(writer.write(batch));
    sample_rounded(batch, adapter.grid(), writer, rounded);
    summary.points_in += count;
    summary.points_out += batch.size();
    monitor.advance(count);
  }
}

/// All but the carried header, which may be large.
WriteOptions without_carry(WriteOptions& options) {
  std::optional<Carry> carry = std::exchange(options.carry, std::nullopt);
  WriteOptions rest = options;
  options.carry = std::move(carry);
  return rest;
}

void note_inputs(Readers readers, bool carries, std::vector<std::string>& notes) {
  for (const Reader* reader : readers)
    for (const std::string& warning : reader->header().warnings)
      notes.push_back(fmt::format("{}: {}", reader->header().path, warning));
  if (readers.size() > 1 && carries)
    notes.push_back("the header is that of the first input of the output's format");
}

/// A scale that was not chosen for the points, by hand or carried on, may be too coarse for them.
void note_rounding(const Writer& writer, const WorldSample& rounded, const ConvertOptions& options,
                   std::vector<std::string>& notes) {
  if (!writer.grid()) return;
  const char* origin = options.scale ? "--scale" : "scale";
  std::string note = coarse_step_note(origin, writer.grid()->scale, rounded.spacing().likely);
  if (!note.empty()) notes.push_back(std::move(note));
}

Result<ConvertSummary> copy_all(Readers readers, std::optional<Carry> carry,
                                const std::string& output, const Format& format,
                                const ConvertOptions& options, Monitor& monitor) {
  PSS_TRY(check_replaceable(output, options.overwrite));
  PSS_ASSIGN(const OutputLock lock, OutputLock::take(output));
  ConvertSummary summary;
  note_inputs(readers, carry.has_value(), summary.notes);
  PSS_ASSIGN(WriteOptions planned,
             plan_conversion(readers, std::move(carry), output, format, options, monitor));
  planned.rules = {options.overwrite, &lock, options.before_rename};
  const WriteOptions shape = without_carry(planned);
  PSS_ASSIGN(const std::unique_ptr<Writer> writer, create_writer(output, std::move(planned)));
  monitor.begin("convert", shape.count);
  WorldSample rounded;
  for (Reader* reader : readers)
    PSS_TRY(copy(*reader, Adapter(*reader, shape, format, options.drop_outside), *writer, rounded,
                 summary, monitor));
  PSS_TRY(writer->finish());
  note_rounding(*writer, rounded, options, summary.notes);
  const auto& written = writer->notes();
  summary.notes.insert(summary.notes.end(), written.begin(), written.end());
  return summary;
}

}  // namespace

Result<ConvertSummary> copy_points(Readers readers, const std::string& output,
                                   const ConvertOptions& options, Monitor& monitor) {
  if (readers.empty()) return Error{Fault::kFailed, "no input: there is nothing to convert"};
  PSS_ASSIGN(const Format* format, format_for(output));
  return copy_all(readers, carry_for(readers, *format), output, *format, options, monitor);
}

Result<ConvertSummary> convert(const std::vector<std::string>& inputs, const std::string& output,
                               const ConvertOptions& options, Monitor& monitor) {
  PSS_ASSIGN(const Format* format, format_for(output));
  PSS_TRY(
      check_grid_options(output, format, options.scale.has_value(), options.offset.has_value()));
  PSS_TRY(check_files(inputs));
  PSS_TRY(check_output(inputs, output));
  if (inputs.empty()) return Error{Fault::kFailed, "no input: there is nothing to convert"};
  std::vector<InputRecord> records;
  for (const std::string& input : inputs) {
    PSS_ASSIGN(InputRecord record, settled_fingerprint(input));
    records.push_back(std::move(record));
  }
  PSS_ASSIGN(OnDemand opened, open_on_demand(records, format->family));
  std::vector<Reader*> readers;
  for (const auto& reader : opened.readers) readers.push_back(reader.get());
  ConvertOptions watched = options;
  watched.before_rename = [&](const WrittenFile& written) -> Result<void> {
    PSS_TRY(check_unchanged(records));
    return options.before_rename ? options.before_rename(written) : Result<void>();
  };
  return copy_all(readers, std::move(opened.carry), output, *format, watched, monitor);
}

}  // namespace pss
