#include "stream/operators/select.h"

#include <fmt/format.h>

#include <cstring>
#include <utility>

#include "io/points/raw_value.h"

namespace pss {
namespace {

constexpr const char* kClass = "Classification";

Schema without_measurements(const Schema& schema) {
  std::vector<Field> fields = schema.fields();
  const std::vector<Field> measured = measurement_schema().fields();
  const bool there = fields.size() >= measured.size() &&
                     std::equal(measured.rbegin(), measured.rend(), fields.rbegin());
  if (there) fields.resize(fields.size() - measured.size());
  return Schema(std::move(fields));
}

bool holds(const Dimension& dimension, std::uint8_t value) {
  return is_float(dimension.type) ||
         integer_limits(dimension.type, dimension.width).highest >= value;
}

}  // namespace

Result<Schema> selected_schema(const Schema& source, const Selection& selection) {
  Schema schema = without_measurements(source);
  if (selection.classify) {
    if (!schema.dimension(kClass)) schema.add({kClass, Type::kUint8, 1, 1, 0, {}});
    for (const std::uint8_t value : {selection.low, selection.high})
      if (!holds(*schema.dimension(kClass), value))
        return Error{Fault::kUsage,
                     fmt::format("the input's {} cannot hold class {}; leave --classify out, which "
                                 "drops the points instead",
                                 kClass, value)};
  }
  if (selection.output.empty()) return schema;
  if (schema.dimension(selection.output))
    return Error{
        Fault::kUsage,
        fmt::format("the input has an attribute {} already; leave --outputs out, or rename "
                    "it",
                    selection.output)};
  schema.add({selection.output, Type::kFloat32, 1, 1, 0, {}});
  return schema;
}

Result<SelectOperator> SelectOperator::create(const Source& source, const Selection& selection) {
  SelectOperator op(source, selection);
  PSS_ASSIGN(op.header_.schema, selected_schema(source.schema(), selection));
  const std::size_t kept = without_measurements(source.schema()).row_size();
  const std::size_t row = op.header_.schema.row_size();
  const std::size_t measured = measurement_schema().row_size();
  op.measured_at_ = row;
  op.needs_.row_size = row + measured;
  if (kept > 0) op.needs_.kept.push_back({0, 0, kept});
  op.needs_.kept.push_back({kept, row, measured});
  op.class_ = op.header_.schema.dimension(kClass);
  op.output_ = op.header_.schema.dimension(selection.output);
  return op;
}

SelectOperator::SelectOperator(const Source& source, const Selection& selection)
    : selection_(selection), header_(source.header()) {
  if (!selection.record.empty()) header_.parameters = selection.record;
}

Measurement SelectOperator::measured(const std::byte* row) const {
  Measurement measured;
  std::memcpy(&measured.value, row + measured_at_, sizeof measured.value);
  measured.above = row[measured_at_ + sizeof measured.value] != std::byte{0};
  return measured;
}

bool SelectOperator::inside(const Measurement& measured) const {
  return measured.value >= selection_.least && measured.value <= selection_.most;
}

void SelectOperator::complete(const Measurement& measured, bool outlier, std::byte* row) const {
  if (outlier && class_)
    write_value(*class_, row, measured.above ? selection_.high : selection_.low);
  if (!output_) return;
  const bool nothing = measured.value == kNothingMeasured;
  write_value(*output_, row, nothing ? -1 : measured.value * selection_.quantum);
}

/// Rows that stay move together in place.
Rows SelectOperator::apply(Part& part, Monitor& monitor) const {
  const std::size_t from = needs_.row_size, to = header_.schema.row_size();
  Rows rows;
  std::size_t kept = 0, i = 0;
  for (const std::uint32_t block : part.block_counts) {
    SelectionCounts counts;
    for (const std::size_t end = i + block; i < end; ++i) {
      std::byte* row = &part.rows[i * from];
      const Measurement found = measured(row);
      const bool excluded = !part.excluded.empty() && part.excluded[i];
      const bool outlier = !excluded && !inside(found);
      ++(excluded      ? counts.excluded
         : !outlier    ? counts.kept
         : found.above ? counts.high
                       : counts.low);
      if (outlier && !selection_.classify) continue;
      complete(found, outlier, row);
      part.own[kept] = part.own[i];
      if (to > 0) std::memmove(&part.rows[kept * to], row, to);
      ++kept;
    }
    rows.notes.push_back(counts.to_bytes());
    monitor.advance(block);
  }
  part.own.resize(kept);
  part.rows.resize(kept * to);
  rows.positions = std::move(part.own);
  rows.bytes = std::move(part.rows);
  return rows;
}

void SelectOperator::merge_note(std::vector<std::byte>& total,
                                std::span<const std::byte> next) const {
  SelectionCounts counts = SelectionCounts::from_bytes(total);
  counts.add(SelectionCounts::from_bytes(next));
  total = counts.to_bytes();
}

}  // namespace pss
