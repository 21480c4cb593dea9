#include "stream/project.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/neighbours.h"
#include "core/parallel.h"

namespace pss {
namespace {

constexpr std::size_t kChunkPoints = 1024;  ///< what one task computes
constexpr int kMostRefinement = 256;
/// A cell grid wants some width, also where no point looks around.
constexpr double kSmallestReach = std::numeric_limits<double>::min();

/// Consecutive own points of one block.
struct Chunk {
  std::size_t block;
  std::size_t first;
  std::size_t count;
};

std::vector<Chunk> chunks_of(const Part& part) {
  std::vector<Chunk> chunks;
  std::size_t start = 0;
  for (std::size_t b = 0; b < part.block_counts.size(); ++b) {
    const std::size_t end = start + part.block_counts[b];
    for (; start < end; start += chunks.back().count)
      chunks.push_back({b, start, std::min(kChunkPoints, end - start)});
  }
  return chunks;
}

/// One note a block, its chunks added up in row order whoever computed them.
std::vector<std::vector<std::byte>> notes_of(const Part& part, const std::vector<Chunk>& chunks,
                                             const std::vector<ProjectStatistics>& statistics) {
  std::vector<ProjectStatistics> blocks(part.block_counts.size());
  for (std::size_t c = 0; c < chunks.size(); ++c) blocks[chunks[c].block].add(statistics[c]);
  std::vector<std::vector<std::byte>> notes;
  for (const ProjectStatistics& block : blocks) notes.push_back(block.to_bytes());
  return notes;
}

/// The largest step count that a move of `length` can take on any axis.
double steps(const Lattice& lattice, double length) {
  return length / std::min({lattice.scale[0], lattice.scale[1], lattice.scale[2]});
}

}  // namespace

Support narrowed(const Support& support, WeightKind weight, double width) {
  if (reach(weight, support) <= width) return support;
  const double beyond = reach(weight, support) - support.radius;
  if (width - beyond >= support.h) return {support.h, width - beyond};
  // The weight is at least as wide as its Gaussian: both shrink.
  const double h = width / (weight == WeightKind::kPcl ? 1.0 : 1.5);
  return {h, h};
}

Lattice refined_lattice(const Lattice& source, const IndexBox& bounds, double largest_move) {
  double extent = 0;
  for (std::size_t a = 0; a < 3 && !bounds.empty(); ++a)
    extent = std::max({extent, std::abs(static_cast<double>(bounds.min[a])),
                       std::abs(static_cast<double>(bounds.max[a]))});
  extent += steps(source, largest_move) + 1;
  int refinement = kMostRefinement;
  while (refinement > 1 && extent * refinement > static_cast<double>(kLatticeMax)) refinement /= 2;
  Lattice refined = source;
  for (double& scale : refined.scale) scale /= refinement;
  return refined;
}

Result<ProjectOperator> ProjectOperator::create(const Store& source,
                                                const ProjectParameters& parameters) {
  ProjectOperator op(source, parameters);
  PSS_ASSIGN(op.columns_, OutputColumns::add_to(op.header_.schema, parameters.outputs));
  return op;
}

ProjectOperator::ProjectOperator(const Store& source, const ProjectParameters& parameters)
    : parameters_(parameters),
      source_lattice_(source.header().lattice),
      exclusion_(source.header().schema),
      header_(source.header()) {
  IndexBox bounds;
  for (const TileInfo& tile : source.tiles()) bounds.add(tile.box);
  // Floating-point input has a fine lattice already.
  if (header_.grid) header_.lattice = refined_lattice(source_lattice_, bounds, largest_reach());
  header_.ordered = false;
  refinement_ = std::llrint(source_lattice_.scale[0] / header_.lattice.scale[0]);
}

Support ProjectOperator::support_at(double distance) const {
  const double radius = parameters_.factor * distance;
  return {radius / radius_factor(parameters_.method.degree), radius};
}

double ProjectOperator::reach_of(const Support& support) const {
  return reach(parameters_.method.weight, support);
}

double ProjectOperator::largest_reach() const {
  if (!parameters_.nearest) return reach_of(parameters_.support);
  return std::max(parameters_.cap, reach_of(support_at(parameters_.cap)));
}

double ProjectOperator::usual_reach() const {
  return parameters_.nearest ? reach_of(support_at(parameters_.first_guess)) : largest_reach();
}

double ProjectOperator::first_reach() const {
  if (parameters_.buffer) return *parameters_.buffer;
  if (!parameters_.nearest) return largest_reach();
  // Half more than the typical query needs: most parts are certified at the first loading.
  return std::min(largest_reach(), 1.5 * usual_reach());
}

std::uint64_t ProjectOperator::bytes(const PartPlan& plan) const {
  const std::uint64_t row = bytes_per_row();
  const std::uint64_t encoded = row + sizeof(Index3) + row / 64 + 1;
  const std::uint64_t supports = parameters_.nearest ? sizeof(Support) : 0;
  const bool looks = largest_reach() > 0;  // where there is no spacing, nothing is evaluated
  const std::uint64_t task =
      Projector::bytes_for(looks ? plan.ball_points : 0) + QueryBatch::bytes_for(kChunkPoints);
  return plan.own_points * (sizeof(Index3) + row + encoded + supports) +
         plan.near_points * sizeof(Index3) + CellGrid::bytes_for(plan.near_points) +
         static_cast<std::uint64_t>(thread_count()) * task;
}

std::optional<double> ProjectOperator::prepare(Part& part) const {
  if (!parameters_.nearest || part.own.empty()) return std::nullopt;
  part.supports.assign(part.own.size(), Support{});
  const double loaded = part.range.reach;
  const double cap = std::min(parameters_.cap, loaded);
  const CellGrid grid(source_lattice_, part.candidates, std::max(loaded, kSmallestReach));
  const std::size_t chunk_count = (part.own.size() + kChunkPoints - 1) / kChunkPoints;
  std::vector<double> needed(chunk_count, 0);
  parallel_for(chunk_count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin * kChunkPoints; i < std::min(end * kChunkPoints, part.own.size());
         ++i) {
      const std::optional<double> distance =
          grid.kth_distance(part.own[i], parameters_.nearest, cap);
      if (distance) part.supports[i] = support_at(*distance);
      double& most = needed[i / kChunkPoints];
      if (distance)
        most = std::max({most, *distance, reach_of(part.supports[i])});
      else if (loaded < parameters_.cap)
        most = std::max(most, 2 * loaded);
    }
  });
  const double wider = std::min(*std::max_element(needed.begin(), needed.end()), largest_reach());
  if (wider <= loaded || parameters_.buffer) return std::nullopt;
  return wider;
}

std::vector<std::vector<std::byte>> ProjectOperator::apply(Part& part, Monitor& monitor) const {
  const std::vector<Chunk> chunks = chunks_of(part);
  std::vector<ProjectStatistics> statistics(chunks.size());
  const CellGrid grid(source_lattice_, part.candidates, std::max(usual_reach(), kSmallestReach));
  parallel_for(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    Projector projector(grid, parameters_.method);
    QueryBatch batch;
    for (std::size_t c = begin; c < end && !monitor.stopping(); ++c) {
      const Chunk& chunk = chunks[c];
      fill(part, chunk.first, chunk.count, batch);
      batch.project(projector);
      for (std::size_t i = 0; i < chunk.count; ++i) {
        Projection projection = batch.answer(i);
        place(projection, part, chunk.first + i);
        statistics[c].add(projection);
      }
      monitor.advance(chunk.count);
    }
  });
  return notes_of(part, chunks, statistics);
}

void ProjectOperator::fill(const Part& part, std::size_t first, std::size_t count,
                           QueryBatch& batch) const {
  batch.clear();
  const double width = parameters_.buffer.value_or(std::numeric_limits<double>::infinity());
  for (std::size_t i = first; i < first + count; ++i) {
    const Support asked = parameters_.nearest ? part.supports[i] : parameters_.support;
    const Support support = narrowed(asked, parameters_.method.weight, width);
    if (exclusion_.active() && exclusion_.excludes(&part.rows[i * bytes_per_row()]))
      batch.add(Status::kExcluded);
    else if (support.radius <= 0)
      batch.add(parameters_.nearest ? Status::kIsolated : Status::kTooFew);
    else
      batch.add(part.own[i], support);
  }
}

void ProjectOperator::place(Projection& projection, Part& part, std::size_t i) const {
  Index3 stays = part.own[i];
  for (std::int64_t& coordinate : stays) coordinate *= refinement_;
  Index3 place = stays;
  if (moved(projection.status)) {
    for (std::size_t a = 0; a < 3; ++a)
      place[a] += std::llrint(projection.displacement[a] / header_.lattice.scale[a]);
    if (!representable(place)) {
      projection.status = Status::kNotRepresentable;
      projection.displacement = {};
      place = stays;
    }
  }
  part.own[i] = place;
  if (bytes_per_row() > 0) columns_.write(projection, &part.rows[i * bytes_per_row()]);
}

bool ProjectOperator::representable(const Index3& index) const {
  if (!on_lattice(index)) return false;
  if (!parameters_.grid) return true;
  const World3 world = to_world(header_.lattice, index);
  for (std::size_t a = 0; a < 3; ++a) {
    const double steps_out = (world[a] - parameters_.grid->origin[a]) / parameters_.grid->scale[a];
    if (!(std::abs(steps_out) < std::numeric_limits<std::int32_t>::max() - 1.0)) return false;
  }
  return true;
}

void ProjectOperator::merge_note(std::vector<std::byte>& tile,
                                 std::span<const std::byte> block) const {
  ProjectStatistics sum = ProjectStatistics::from_bytes(tile);
  sum.add(ProjectStatistics::from_bytes(block));
  tile = sum.to_bytes();
}

}  // namespace pss
