#include "stream/operators/project_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <type_traits>

namespace pss {
namespace {

double ratio(double a, std::uint64_t b) { return b ? a / static_cast<double>(b) : 0; }

}  // namespace

static_assert(std::is_trivially_copyable_v<ProjectStatistics>);

void ProjectStatistics::add(const Projection& projection) {
  ++statuses[static_cast<std::size_t>(projection.status) % kStatusCount];
  neighbours += projection.neighbours;
  evaluated += projection.neighbours ? 1 : 0;
  most_neighbours = std::max<std::uint64_t>(most_neighbours, projection.neighbours);
  second_sheet += projection.second_sheet ? 1 : 0;
  redone += projection.redone ? 1 : 0;
  if (!pss::moved(projection.status)) return;
  const World3& d = projection.displacement;
  const double length_sq = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  displacement_sq += length_sq;
  largest_displacement = std::max(largest_displacement, std::sqrt(length_sq));
  residual_sq += projection.residual * projection.residual;
}

void ProjectStatistics::add(const ProjectStatistics& other) {
  for (std::size_t s = 0; s < statuses.size(); ++s) statuses[s] += other.statuses[s];
  neighbours += other.neighbours;
  evaluated += other.evaluated;
  most_neighbours = std::max(most_neighbours, other.most_neighbours);
  second_sheet += other.second_sheet;
  redone += other.redone;
  displacement_sq += other.displacement_sq;
  largest_displacement = std::max(largest_displacement, other.largest_displacement);
  residual_sq += other.residual_sq;
}

std::uint64_t ProjectStatistics::points() const {
  return std::accumulate(statuses.begin(), statuses.end(), std::uint64_t{0});
}

std::uint64_t ProjectStatistics::moved() const {
  return statuses[static_cast<std::size_t>(Status::kOk)] +
         statuses[static_cast<std::size_t>(Status::kDegreeReduced)];
}

double ProjectStatistics::mean_neighbours() const {
  return ratio(static_cast<double>(neighbours), evaluated);
}
double ProjectStatistics::redone_share() const {
  return ratio(static_cast<double>(redone), evaluated);
}
double ProjectStatistics::rms_displacement() const {
  return std::sqrt(ratio(displacement_sq, moved()));
}
double ProjectStatistics::rms_residual() const { return std::sqrt(ratio(residual_sq, moved())); }

std::vector<std::byte> ProjectStatistics::to_bytes() const {
  std::vector<std::byte> bytes(sizeof *this);
  std::memcpy(bytes.data(), this, sizeof *this);
  return bytes;
}

ProjectStatistics ProjectStatistics::from_bytes(std::span<const std::byte> bytes) {
  ProjectStatistics statistics;
  if (bytes.size() == sizeof statistics) std::memcpy(&statistics, bytes.data(), sizeof statistics);
  return statistics;
}

Result<ProjectStatistics> ProjectStatistics::from_note(const Note& note, const std::string& store) {
  PSS_ASSIGN(const std::span<const std::byte> bytes, bytes_of(note, kVersion, store));
  return from_bytes(bytes);
}

}  // namespace pss
