#include "io/formats/text/text_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include "io/file/output_file.h"
#include "io/formats/text/text_plan.h"
#include "io/points/announced_count.h"
#include "io/points/numbers.h"
#include "io/points/positions.h"

namespace pss {
namespace {

/// Text gathered before it goes to the file.
constexpr std::size_t kPiece = std::size_t{64} << 10;

/// What rounding may have done to offset + scale * integer.
double decimal_tolerance(double offset, double value) {
  return 0x1p-51 * (std::abs(offset) + std::abs(value));
}

class TextWriter final : public Writer {
 public:
  TextWriter(OutputFile output, TextPlan plan, const WriteOptions& options)
      : output_(std::move(output)),
        plan_(std::move(plan)),
        grid_(options.grid),
        tolerance_(options.tolerance),
        row_size_(options.schema.row_size()),
        count_(options.count) {}

  std::optional<Lattice> grid() const override { return std::nullopt; }
  const std::vector<std::string>& notes() const override { return plan_.notes; }
  Result<void> start();
  Result<void> write(const PointBatch& batch) override;
  Result<void> finish() override;

 private:
  void append_position(const PointBatch& batch, std::size_t point, std::size_t axis);
  void append_value(const TextSource& source, const std::byte* row);
  Result<void> flush();

  OutputFile output_;
  TextPlan plan_;
  std::optional<Lattice> grid_;
  double tolerance_;
  std::size_t row_size_;
  AnnouncedCount count_;
  std::uint64_t count_offset_ = 0;
  std::string pending_;
};

Result<void> TextWriter::start() {
  const TextLayout& layout = plan_.layout;
  for (const std::string& comment : layout.comments) pending_ += comment + "\n";
  if (layout.header)
    pending_ += *layout.header +
                fmt::format("{}\n", fmt::join(layout.columns, std::string(1, layout.separator)));
  count_offset_ = pending_.size();
  if (layout.counted) pending_ += fmt::format("{}\n", count_.announced());
  return flush();
}

Result<void> TextWriter::write(const PointBatch& batch) {
  PSS_TRY(count_.check(output_.path(), batch.size()));
  count_.add(batch.size());
  for (std::size_t i = 0; i < batch.size(); ++i) {
    for (const TextSource& source : plan_.sources) {
      if (source.axis) {
        append_position(batch, i, *source.axis);
      } else {
        append_value(source, batch.rows.data() + i * row_size_);
      }
      pending_.push_back(plan_.layout.separator);
    }
    pending_.back() = '\n';
    if (pending_.size() >= kPiece) PSS_TRY(flush());
  }
  return {};
}

void TextWriter::append_position(const PointBatch& batch, std::size_t point, std::size_t axis) {
  const double value = world_position(batch, grid_, point)[axis];
  if (batch.index.empty()) return append_number(value, pending_);
  const double rounding = decimal_tolerance(grid_->origin[axis], value);
  append_decimal(value, std::max(rounding, tolerance_), pending_);
}

void TextWriter::append_value(const TextSource& source, const std::byte* row) {
  const Dimension& from = source.dimension;
  const std::byte* place = row + from.position + source.element * size_of(from.type);
  const bool scaled = from.scale != 1 || from.offset != 0;
  if (!scaled && from.width == 0) return append_number(from.type, place, pending_);
  const double value = read_value(from, row, source.element);
  append_decimal(value, scaled ? decimal_tolerance(from.offset, value) : 0, pending_);
}

Result<void> TextWriter::flush() {
  PSS_TRY(output_.append(std::string_view(pending_)));
  pending_.clear();
  return {};
}

Result<void> TextWriter::finish() {
  PSS_TRY(flush());
  if (plan_.layout.counted) PSS_TRY(count_.correct(output_, count_offset_));
  return output_.finish();
}

}  // namespace

Result<std::unique_ptr<Writer>> create_text(const std::string& path, const WriteOptions& options) {
  PSS_ASSIGN(TextPlan plan, plan_text(path, options));
  PSS_ASSIGN(OutputFile output, OutputFile::create(path, options.rules));
  auto writer = std::make_unique<TextWriter>(std::move(output), std::move(plan), options);
  PSS_TRY(writer->start());
  return std::unique_ptr<Writer>(std::move(writer));
}

}  // namespace pss
