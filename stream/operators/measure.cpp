#include "stream/operators/measure.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "core/parallel.h"
#include "stream/operators/query_batch.h"

namespace pss {
namespace {

constexpr std::size_t kRowSize = sizeof(std::uint32_t) + 1;

/// The power of two by which lengths up to `longest` are values below 2^31.
double quantum_for(double longest) { return std::ldexp(1.0, std::ilogb(longest) + 1 - 31); }

bool same_place(const Part& part, std::size_t i, std::size_t first) {
  return i > first && part.own[i] == part.own[i - 1];
}

}  // namespace

Schema measurement_schema() {
  return Schema(
      {{kValueColumn, Type::kUint32, 1, 1, 0, {}}, {kAboveColumn, Type::kUint8, 1, 1, 0, {}}});
}

void MeasurementSums::add(const Measurement& measured, bool is_excluded) {
  if (is_excluded)
    ++excluded;
  else if (measured.value == kNothingMeasured)
    ++nothing;
  else
    values.add(measured.value);
}

void MeasurementSums::add(const MeasurementSums& other) {
  values.add(other.values);
  nothing += other.nothing;
  excluded += other.excluded;
}

std::vector<std::byte> MeasurementSums::to_bytes() const {
  std::vector<std::byte> bytes = values.to_bytes();
  const std::size_t size = bytes.size();
  bytes.resize(size + sizeof nothing + sizeof excluded);
  std::memcpy(&bytes[size], &nothing, sizeof nothing);
  std::memcpy(&bytes[size + sizeof nothing], &excluded, sizeof excluded);
  return bytes;
}

MeasurementSums MeasurementSums::from_bytes(std::span<const std::byte> bytes) {
  MeasurementSums sums;
  const std::size_t size = sums.to_bytes().size() - 2 * sizeof(std::uint64_t);
  if (bytes.size() != size + 2 * sizeof(std::uint64_t)) return sums;
  sums.values = FixedSums::from_bytes(bytes.first(size));
  std::memcpy(&sums.nothing, &bytes[size], sizeof sums.nothing);
  std::memcpy(&sums.excluded, &bytes[size + sizeof sums.nothing], sizeof sums.excluded);
  return sums;
}

MeasureOperator::MeasureOperator(const Source& source, Neighbourhood neighbourhood, double quantum,
                                 const std::string& record)
    : header_(source.header()), neighbourhood_(std::move(neighbourhood)), quantum_(quantum) {
  header_.schema = measurement_schema();
  header_.inputs = {};  // the source that the columns are joined to knows them
  header_.parameters = record;
  needs_.row_size = kRowSize;
}

std::uint32_t MeasureOperator::in_quanta(double measured) const {
  return static_cast<std::uint32_t>(
      std::min(std::nearbyint(measured / quantum_), double{kNothingMeasured - 1}));
}

/// Measures a slice and writes its rows.
MeasurementSums MeasureOperator::measure(const Slice& slice, Part& part) const {
  std::vector<Measurement> measured(slice.count, {kNothingMeasured, false});
  measure(part, slice.first, measured);
  MeasurementSums sums;
  for (std::size_t i = 0; i < slice.count; ++i) {
    const std::size_t own = slice.first + i;
    const bool excluded = !part.excluded.empty() && part.excluded[own];
    if (excluded) measured[i] = {kNothingMeasured, false};
    sums.add(measured[i], excluded);
    std::byte* row = &part.rows[own * kRowSize];
    std::memcpy(row, &measured[i].value, sizeof measured[i].value);
    row[sizeof measured[i].value] = std::byte{measured[i].above};
  }
  return sums;
}

Rows MeasureOperator::apply(Part& part, Monitor& monitor) const {
  const std::vector<Slice> slices = slices_of(part);
  std::vector<MeasurementSums> sums(slices.size());
  parallel_for(slices.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end && !monitor.stopping(); ++c) {
      sums[c] = measure(slices[c], part);
      monitor.advance(slices[c].count);
    }
  });
  std::vector<MeasurementSums> blocks(part.block_counts.size());
  for (std::size_t c = 0; c < slices.size(); ++c) blocks[slices[c].block].add(sums[c]);
  Rows rows{{}, std::move(part.rows), {}};
  for (const MeasurementSums& block : blocks) rows.notes.push_back(block.to_bytes());
  return rows;
}

void MeasureOperator::merge_note(std::vector<std::byte>& total,
                                 std::span<const std::byte> next) const {
  MeasurementSums sums = MeasurementSums::from_bytes(total);
  sums.add(MeasurementSums::from_bytes(next));
  total = sums.to_bytes();
}

MeanDistance::MeanDistance(const Source& source, int k, double cap, double guess,
                           const std::string& record)
    : MeasureOperator(
          source,
          Neighbourhood::nearest(
              {.k = k, .each_point = true, .cap = cap, .first_guess = guess, .reach_at = {}}),
          quantum_for(cap), record),
      k_(k),
      cap_(cap) {}

void MeanDistance::measure(const Part& part, std::size_t first, std::span<Measurement> out) const {
  for (std::size_t i = first; i < first + out.size(); ++i)
    out[i - first] = same_place(part, i, first) ? out[i - first - 1] : measure(part, i);
}

/// Of those at the k-th distance as many count as the nearer ones leave.
Measurement MeanDistance::measure(const Part& part, std::size_t i) const {
  const double farthest = part.kth_distances[i];
  if (farthest < 0) return {kNothingMeasured, part.grid->sum_ball(part.own[i], cap_).heights < 0};
  if (farthest == 0) return {0, false};
  const BallSum nearer = part.grid->sum_ball(part.own[i], farthest);
  const auto others = static_cast<double>(nearer.points - 1);
  const double sum = nearer.distances + (k_ - others) * farthest;
  return {in_quanta(sum / k_), nearer.heights < 0};
}

NeighbourCount::NeighbourCount(const Source& source, double radius, const std::string& record)
    : MeasureOperator(source, Neighbourhood::fixed(radius), 1, record), radius_(radius) {}

void NeighbourCount::measure(const Part& part, std::size_t first,
                             std::span<Measurement> out) const {
  for (std::size_t i = first; i < first + out.size(); ++i) {
    Measurement& measured = out[i - first];
    if (same_place(part, i, first)) {
      measured = out[i - first - 1];
      continue;
    }
    const BallSum ball = part.grid->sum_ball(part.own[i], radius_);
    const std::uint64_t others = ball.points > 0 ? ball.points - 1 : 0;
    measured.value = in_quanta(static_cast<double>(others));
    measured.above = ball.heights < 0;
  }
}

FitResidual::FitResidual(const Source& source, const Method& method, const Support& support,
                         const std::string& record)
    : MeasureOperator(source, Neighbourhood::fixed(reach(method.weight, support)),
                      std::ldexp(1.0, -24), record),
      method_(method),
      support_(support),
      gate_(method, support.radius / support.h) {}

std::uint64_t FitResidual::scratch_bytes(std::uint64_t ball_points) const {
  return Projector::bytes_for(ball_points, method_.op) + QueryBatch::bytes_for(kTaskPoints);
}

void FitResidual::measure(const Part& part, std::size_t first, std::span<Measurement> out) const {
  Projector projector(*part.grid, method_);
  QueryBatch batch;
  batch.clear();
  for (std::size_t i = first; i < first + out.size(); ++i) batch.add(part.own[i], support_);
  batch.project(projector);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Projection projection = batch.answer(i);
    out[i].above = projection.displacement[2] < 0;
    if (moved(projection.status)) out[i].value = in_quanta(gate_.residual(projection) / support_.h);
  }
}

}  // namespace pss
