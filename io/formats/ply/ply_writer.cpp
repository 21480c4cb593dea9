#include "io/formats/ply/ply_writer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "io/file/output_file.h"
#include "io/formats/ply/ply_plan.h"
#include "io/points/announced_count.h"
#include "io/points/numbers.h"
#include "io/points/positions.h"
#include "io/points/raw_value.h"

namespace pss {
namespace {

using ValueBytes = std::array<std::byte, 8>;

/// Bytes gathered before they go to the file.
constexpr std::size_t kPiece = std::size_t{64} << 10;

/// Rounds a coordinate to a type; false where the type has no such value.
bool store_coordinate(double value, const Dimension& target, std::byte* bytes) {
  if (!is_float(target.type)) {
    const double rounded = std::nearbyint(value);
    const IntegerLimits limits = integer_limits(target.type, 0);
    if (!(rounded >= -static_cast<double>(limits.lowest) &&
          rounded <= static_cast<double>(limits.highest)))
      return false;
  } else if (target.type == Type::kFloat32) {
    if (std::isfinite(value) && std::abs(value) > std::numeric_limits<float>::max()) return false;
  }
  store_double(target, bytes, value, 0);
  return true;
}

class PlyWriter final : public Writer {
 public:
  PlyWriter(OutputFile output, PlyPlan plan, const WriteOptions& options);

  std::optional<Lattice> grid() const override { return std::nullopt; }
  const std::vector<std::string>& notes() const override { return plan_.notes; }
  Result<void> start();
  Result<void> write(const PointBatch& batch) override;
  Result<void> finish() override;

 private:
  Result<void> write_point(const World3& position, const std::byte* row);
  Result<void> load(std::size_t property, const World3& position, const std::byte* row,
                    ValueBytes& value);
  void append(Type type, const ValueBytes& value);
  Result<void> flush();
  std::uint64_t count_offset() const;
  void note_rounding();

  OutputFile output_;
  PlyPlan plan_;
  std::vector<Dimension> targets_;  ///< one a property
  std::optional<Lattice> grid_;
  std::size_t row_size_;
  AnnouncedCount count_;
  std::string head_;
  std::string pending_;
  double rounding_ = 0;  ///< the largest change of a coordinate
};

PlyWriter::PlyWriter(OutputFile output, PlyPlan plan, const WriteOptions& options)
    : output_(std::move(output)),
      plan_(std::move(plan)),
      grid_(options.grid),
      row_size_(options.schema.row_size()),
      count_(options.count) {
  for (const PlySource& source : plan_.sources)
    targets_.push_back({.name = {}, .type = source.type});
}

Result<void> PlyWriter::start() {
  head_ = format_ply_header(plan_.header);
  return output_.append(std::string_view(head_));
}

Result<void> PlyWriter::write(const PointBatch& batch) {
  PSS_TRY(count_.check(output_.path(), batch.size()));
  for (std::size_t i = 0; i < batch.size(); ++i, count_.add(1))
    PSS_TRY(write_point(world_position(batch, grid_, i), batch.rows.data() + i * row_size_));
  return {};
}

Result<void> PlyWriter::write_point(const World3& position, const std::byte* row) {
  ValueBytes value{};
  for (std::size_t i = 0; i < plan_.sources.size(); ++i) {
    PSS_TRY(load(i, position, row, value));
    append(plan_.sources[i].type, value);
  }
  if (plan_.header.encoding == PlyEncoding::kAscii) pending_.back() = '\n';
  return pending_.size() < kPiece ? Result<void>() : flush();
}

/// The value of a property in little-endian bytes.
Result<void> PlyWriter::load(std::size_t property, const World3& position, const std::byte* row,
                             ValueBytes& value) {
  const PlySource& source = plan_.sources[property];
  const Dimension& from = source.dimension;
  if (source.verbatim) {
    const std::size_t size = size_of(source.type);
    std::memcpy(value.data(), row + from.position + source.element * size, size);
  } else if (!source.axis) {
    store_double(targets_[property], value.data(), read_value(from, row, source.element), 0);
  } else {
    const double wanted = position[*source.axis];
    if (!store_coordinate(wanted, targets_[property], value.data()))
      return Error{Fault::kBadInput,
                   fmt::format("{}: point {} has {} = {}, which the file's type {} cannot hold",
                               output_.path(), count_.come(), "xyz"[*source.axis], wanted,
                               type_name(source.type))};
    if (source.type != Type::kFloat64 && std::isfinite(wanted))
      rounding_ =
          std::max(rounding_, std::abs(load_double(targets_[property], value.data(), 0) - wanted));
  }
  return {};
}

void PlyWriter::append(Type type, const ValueBytes& value) {
  if (plan_.header.encoding == PlyEncoding::kAscii) {
    append_number(type, value.data(), pending_);
    pending_.push_back(' ');
    return;
  }
  const auto* bytes = reinterpret_cast<const char*>(value.data());
  pending_.append(bytes, size_of(type));
  if (plan_.header.encoding == PlyEncoding::kBigEndian)
    std::reverse(pending_.end() - static_cast<std::ptrdiff_t>(size_of(type)), pending_.end());
}

Result<void> PlyWriter::flush() {
  PSS_TRY(output_.append(std::string_view(pending_)));
  pending_.clear();
  return {};
}

/// Where the header says how many points there are.
std::uint64_t PlyWriter::count_offset() const {
  constexpr std::string_view kBefore = "\nelement vertex ";
  return head_.find(kBefore) + kBefore.size();
}

void PlyWriter::note_rounding() {
  if (rounding_ == 0) return;
  const auto is_axis = [](const PlySource& source) { return source.axis.has_value(); };
  const auto first = std::ranges::find_if(plan_.sources, is_axis);
  plan_.notes.push_back(
      fmt::format("x, y, z are written as {}, as in the source: the largest "
                  "rounding is {:.3g}",
                  type_name(first->type), rounding_));
}

Result<void> PlyWriter::finish() {
  PSS_TRY(flush());
  PSS_TRY(count_.correct(output_, count_offset()));
  note_rounding();
  return output_.finish();
}

}  // namespace

Result<std::unique_ptr<Writer>> create_ply(const std::string& path, const WriteOptions& options) {
  PSS_ASSIGN(PlyPlan plan, plan_ply(path, options));
  PSS_ASSIGN(OutputFile output, OutputFile::create(path, options.rules));
  auto writer = std::make_unique<PlyWriter>(std::move(output), std::move(plan), options);
  PSS_TRY(writer->start());
  return std::unique_ptr<Writer>(std::move(writer));
}

}  // namespace pss
