#include "io/formats/las/las_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "io/file/bytes.h"
#include "io/file/output_file.h"
#include "io/formats/las/las_plan.h"
#include "io/formats/las/las_schema.h"
#include "io/formats/las/las_vlr.h"
#include "io/points/announced_count.h"

namespace pss {
namespace {

constexpr std::int64_t kMin = std::numeric_limits<std::int32_t>::min();
constexpr std::int64_t kMax = std::numeric_limits<std::int32_t>::max();

/// Counts the points by return, as both generations of headers have them.
class ReturnCounts {
 public:
  explicit ReturnCounts(const Dimension& number) : number_(number) {}

  void add(const std::byte* row) {
    const unsigned byte = std::to_integer<unsigned>(row[number_.position]);
    ++counts_[(byte >> number_.shift) & ((1u << number_.width) - 1)];
  }

  void store(LasHeader& header, bool legacy) const {
    for (std::size_t r = 0; r < kLasReturns; ++r) header.by_return[r] = counts_[r + 1];
    for (std::size_t r = 0; r < kLasLegacyReturns; ++r)
      header.legacy_by_return[r] = legacy ? static_cast<std::uint32_t>(counts_[r + 1]) : 0;
  }

 private:
  Dimension number_;
  std::array<std::uint64_t, 16> counts_{};  ///< 0 is no return, and in no header field
};

/// An attribute whose values may not all fit, and how many did not.
struct Narrowed {
  Dimension from, to;
  std::uint64_t changed = 0;

  void check(const std::byte* before, const std::byte* after) {
    for (std::uint32_t e = 0; e < from.count; ++e)
      if (e >= to.count || read_value(from, before, e) != read_value(to, after, e)) {
        ++changed;
        return;
      }
  }
};

class LasWriter : public Writer {
 public:
  LasWriter(OutputFile file, LasPlan plan, const WriteOptions& options)
      : file_(std::move(file)),
        plan_(std::move(plan)),
        source_grid_(options.grid),
        count_(options.count),
        source_row_size_(options.schema.row_size()),
        mapper_(with_las_names(options.schema), plan_.schema),
        returns_(*plan_.schema.dimension("ReturnNumber")) {
    keeps_header_ =
        options.same_points && plan_.keeps_layout && source_grid_ == plan_.header.grid();
    const Schema named = with_las_names(options.schema);
    for (const std::string& name : mapper_.narrowed())
      narrowed_.push_back({*named.dimension(name), *plan_.schema.dimension(name)});
  }

  Result<void> begin() {
    drop_wave_data();
    PSS_TRY(file_.append(plan_.head));
    // Only the header block is written again; VLRs of many megabytes need not be held till then.
    plan_.head.resize(plan_.header.header_size);
    plan_.head.shrink_to_fit();
    return {};
  }

  std::optional<Lattice> grid() const override { return plan_.header.grid(); }
  const std::vector<std::string>& notes() const override { return plan_.notes; }

  Result<void> write(const PointBatch& batch) override {
    PSS_TRY(count_.check(file_.path(), batch.size()));
    map_rows(batch);
    const std::size_t row_size = plan_.schema.row_size();
    records_.resize(batch.size() * (kLasPositionSize + row_size));
    std::span<std::byte> record(records_);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      PSS_ASSIGN(const Index3 index, position(batch, i));
      for (std::size_t a = 0; a < 3; ++a)
        store_le(record, 4 * a, static_cast<std::int32_t>(index[a]));
      const std::byte* row = rows_.data() + i * row_size;
      std::copy_n(row, row_size, record.begin() + kLasPositionSize);
      box_.add(index);
      returns_.add(row);
      record = record.subspan(kLasPositionSize + row_size);
    }
    count_.add(batch.size());
    return file_.append(records_);
  }

  Result<void> finish() override {
    note_narrowed();
    if (keeps_header_ && count_.come() == plan_.header.points())
      note_bounds();
    else
      describe_points();
    PSS_TRY(place_evlrs());
    store_las_header(plan_.header, plan_.head);
    PSS_TRY(file_.patch(0, plan_.head));
    return file_.finish();
  }

 private:
  void map_rows(const PointBatch& batch) {
    rows_.resize(batch.size() * plan_.schema.row_size());
    mapper_.map(batch.rows, rows_);
    for (Narrowed& narrowed : narrowed_)
      for (std::size_t i = 0; i < batch.size(); ++i)
        narrowed.check(batch.rows.data() + i * source_row_size_,
                       rows_.data() + i * plan_.schema.row_size());
  }

  Result<Index3> position(const PointBatch& batch, std::size_t i) const {
    const Lattice grid = plan_.header.grid();
    if (!batch.index.empty() && source_grid_ == grid) {
      const Index3& index = batch.index[i];
      for (std::size_t a = 0; a < 3; ++a)
        if (index[a] < kMin || index[a] > kMax) return unfit(to_world(grid, index), a, i);
      return index;
    }
    const World3 world = batch.index.empty()
                             ? batch.world[i]
                             : to_world(source_grid_.value_or(Lattice{}), batch.index[i]);
    Index3 index{};
    for (std::size_t a = 0; a < 3; ++a) {
      const double steps = std::nearbyint((world[a] - grid.origin[a]) / grid.scale[a]);
      if (!(steps >= static_cast<double>(kMin) && steps <= static_cast<double>(kMax)))
        return unfit(world, a, i);  // also NaN
      index[a] = static_cast<std::int64_t>(steps);
    }
    return index;
  }

  Error unfit(const World3& world, std::size_t axis, std::size_t i) const {
    const double scale = plan_.header.scale[axis];
    const double offset = plan_.header.offset[axis];
    return {Fault::kBadInput,
            fmt::format("{}: point {}: found {} = {}, expected {} to {}, which is what scale {} "
                        "and offset {} can hold; use --scale or --offset",
                        file_.path(), count_.come() + i, "xyz"[axis], world[axis],
                        offset + scale * static_cast<double>(kMin),
                        offset + scale * static_cast<double>(kMax), scale, offset)};
  }

  /// The packets themselves are not carried, so the header must not point to them.
  void drop_wave_data() {
    if (plan_.header.wave_offset == 0) return;
    plan_.header.wave_offset = 0;
    plan_.header.global_encoding &= static_cast<std::uint16_t>(~kLasInternalWave);
    plan_.notes.push_back("waveform data packets are dropped; the points keep their fields");
  }

  void note_narrowed() {
    for (const Narrowed& narrowed : narrowed_)
      if (narrowed.changed > 0)
        plan_.notes.push_back(
            fmt::format("{}: {} values were rounded or clamped to what the point "
                        "format holds",
                        narrowed.to.name, narrowed.changed));
  }

  void note_bounds() {
    if (box_.empty()) return;
    const World3 min = to_world(plan_.header.grid(), box_.min);
    const World3 max = to_world(plan_.header.grid(), box_.max);
    for (std::size_t a = 0; a < 3; ++a) {
      const double step = plan_.header.scale[a];
      if (min[a] >= plan_.header.min[a] - step && max[a] <= plan_.header.max[a] + step) continue;
      plan_.notes.push_back(
          "the input's header has bounds that do not hold all its points; they "
          "are kept");
      return;
    }
  }

  void describe_points() {
    LasHeader& h = plan_.header;
    const bool legacy =
        plan_.legacy_counts && count_.come() <= std::numeric_limits<std::uint32_t>::max();
    h.count = count_.come();
    h.legacy_count = legacy ? static_cast<std::uint32_t>(count_.come()) : 0;
    returns_.store(h, legacy);
    h.min = box_.empty() ? World3{} : to_world(h.grid(), box_.min);
    h.max = box_.empty() ? World3{} : to_world(h.grid(), box_.max);
  }

  Result<void> place_evlrs() {
    LasHeader& h = plan_.header;
    const std::size_t evlrs = list_evlrs(plan_.tail).size();
    if (evlrs != 0 || h.evlr_count != 0 || !keeps_header_)
      h.evlr_offset = evlrs == 0 ? 0 : file_.position();
    h.evlr_count = static_cast<std::uint32_t>(evlrs);
    return file_.append(plan_.tail);
  }

  OutputFile file_;
  LasPlan plan_;
  std::optional<Lattice> source_grid_;
  AnnouncedCount count_;
  std::size_t source_row_size_ = 0;
  RowMapper mapper_;
  ReturnCounts returns_;
  std::vector<Narrowed> narrowed_;
  bool keeps_header_ = false;
  IndexBox box_;
  std::vector<std::byte> rows_;
  std::vector<std::byte> records_;
};

Result<void> check_options(const WriteOptions& options) {
  for (std::size_t a = 0; a < 3; ++a) {
    if (options.scale && !(std::isnormal((*options.scale)[a]) && (*options.scale)[a] > 0))
      return Error{Fault::kUsage, fmt::format("--scale: found {}, expected a positive number",
                                              (*options.scale)[a])};
    if (options.offset && !std::isfinite((*options.offset)[a]))
      return Error{Fault::kUsage,
                   fmt::format("--offset: found {}, expected a number", (*options.offset)[a])};
  }
  return {};
}

}  // namespace

Result<std::optional<Lattice>> plan_las_grid(const std::string& path, WriteOptions options) {
  PSS_TRY(check_options(options));
  PSS_ASSIGN(const LasPlan plan, plan_las(path, options));
  return plan.header.grid();
}

Result<std::unique_ptr<Writer>> create_las(const std::string& path, WriteOptions options) {
  PSS_TRY(check_options(options));
  PSS_ASSIGN(LasPlan plan, plan_las(path, options));
  PSS_ASSIGN(OutputFile file, OutputFile::create(path, options.rules));
  auto writer = std::make_unique<LasWriter>(std::move(file), std::move(plan), options);
  PSS_TRY(writer->begin());
  return std::unique_ptr<Writer>(std::move(writer));
}

}  // namespace pss
