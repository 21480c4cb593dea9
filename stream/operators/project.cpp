#include "stream/operators/project.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

#include "core/neighbours.h"
#include "core/parallel.h"
#include "core/spares.h"
#include "core/support.h"

namespace pss {
namespace {

constexpr int kMostRefinement = 256;

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

Result<ProjectOperator> ProjectOperator::create(const Source& source,
                                                const ProjectParameters& parameters) {
  ProjectOperator op(source, parameters);
  op.choose_normals(source.schema());
  PSS_TRY(op.choose_columns());
  return op;
}

ProjectOperator::ProjectOperator(const Source& source, const ProjectParameters& parameters)
    : parameters_(parameters),
      source_lattice_(source.lattice()),
      header_(source.header()),
      neighbourhood_(chosen_neighbourhood()) {
  header_.schema = source.schema();
  if (!parameters.record.empty()) header_.parameters = parameters.record;
  if (!parameters.only_normals) choose_lattice(source);
}

Neighbourhood ProjectOperator::chosen_neighbourhood() const {
  const Method& method = parameters_.method;
  const auto reach_of = [weight = method.weight](const Support& support) {
    return reach(weight, support);
  };
  if (!parameters_.nearest) {
    const auto fixed = Neighbourhood::fixed(reach_of(parameters_.support));
    return parameters_.buffer ? fixed.narrowed(*parameters_.buffer) : fixed;
  }
  const auto reach_at = [reach_of, method, factor = parameters_.factor](double distance) {
    return reach_of(support_of_radius(factor * distance, method));
  };
  const auto nearest = Neighbourhood::nearest({.k = parameters_.nearest,
                                               .cap = parameters_.cap,
                                               .first_guess = parameters_.first_guess,
                                               .reach_at = reach_at});
  return parameters_.buffer ? nearest.narrowed(*parameters_.buffer) : nearest;
}

Support ProjectOperator::support_of(const Part& part, std::size_t i) const {
  if (!parameters_.nearest) return parameters_.support;
  const double distance = part.kth_distances[i];
  return distance < 0 ? Support{0, 0} : support_at(distance);
}

Support ProjectOperator::support_at(double distance) const {
  return support_of_radius(parameters_.factor * distance, parameters_.method);
}

std::uint64_t ProjectOperator::scratch_bytes(std::uint64_t ball_points) const {
  return Projector::bytes_for(ball_points, parameters_.method.op) +
         QueryBatch::bytes_for(kTaskPoints);
}

void ProjectOperator::choose_lattice(const Source& source) {
  IndexBox bounds;
  for (const TileInfo& tile : source.tiles()) bounds.add(tile.box);
  // Floating-point input has a fine lattice already.
  if (header_.grid)
    header_.lattice = refined_lattice(source_lattice_, bounds, neighbourhood_.largest_reach());
  header_.ordered = false;
  refinement_ = std::llrint(source_lattice_.scale[0] / header_.lattice.scale[0]);
}

void ProjectOperator::choose_normals(const Schema& source) {
  if (!needs_normals(parameters_.method.op)) return;
  needs_.normals = NormalColumns::given(source);
  oriented_ = needs_.normals.has_value();
  if (oriented_) return;
  needs_.normals = NormalColumns::computed(source);
  header_.schema = without_computed_normals(source);
}

Result<void> ProjectOperator::choose_columns() {
  if (columns_alone()) {
    header_.schema = Schema();
    header_.inputs = {};  // the source that the columns are joined to knows them
    PSS_ASSIGN(columns_, OutputColumns::add_to(header_.schema, kNormals, kComputedPrefix));
  } else {
    PSS_ASSIGN(columns_, OutputColumns::add_to(header_.schema, parameters_.outputs));
    needs_.kept = columns_.kept();
  }
  needs_.row_size = header_.schema.row_size();
  return {};
}

/// One note a block, its slices added up in row order whoever computed them.
std::vector<std::vector<std::byte>> ProjectOperator::notes_of(
    const Part& part, const std::vector<Slice>& slices,
    const std::vector<ProjectStatistics>& statistics) {
  std::vector<ProjectStatistics> blocks(part.block_counts.size());
  for (std::size_t c = 0; c < slices.size(); ++c) blocks[slices[c].block].add(statistics[c]);
  std::vector<std::vector<std::byte>> notes;
  for (const ProjectStatistics& block : blocks) notes.push_back(block.to_bytes());
  return notes;
}

Rows ProjectOperator::apply(Part& part, Monitor& monitor) const {
  const std::vector<Slice> slices = slices_of(part);
  const std::vector<PointRange> tasks = tasks_of(part, slices);
  std::vector<ProjectStatistics> statistics(slices.size());
  assert(!needs_normals(parameters_.method.op) || part.normals.size() == part.candidates.size());
  if (!part.grid) part.grid.emplace(source_lattice_, part.candidates, kSmallestReach);
  Spares<Worker> workers;
  parallel_for(tasks.size(), 1, [&](std::size_t begin, std::size_t end) {
    std::unique_ptr<Worker> worker = workers.take();
    if (!worker)
      worker = std::make_unique<Worker>(*part.grid, parameters_.method,
                                        CloudNormals{part.normals, oriented_});
    const std::size_t last = tasks[end - 1].end;
    for (std::size_t c = tasks[begin].begin; c < last && !monitor.stopping(); ++c) {
      statistics[c] = project(slices[c], *worker, part);
      monitor.advance(slices[c].count);
    }
    workers.give(std::move(worker));
  });
  Rows rows{{}, std::move(part.rows), notes_of(part, slices, statistics)};
  if (!columns_alone()) rows.positions = std::move(part.own);
  return rows;
}

ProjectStatistics ProjectOperator::project(const Slice& slice, Worker& worker, Part& part) const {
  ProjectStatistics statistics;
  fill(part, slice.first, slice.count, worker.batch);
  worker.batch.project(worker.projector);
  for (std::size_t i = 0; i < slice.count; ++i) {
    Projection projection = worker.batch.answer(i);
    place(projection, part, slice.first + i);
    statistics.add(projection);
  }
  return statistics;
}

void ProjectOperator::fill(const Part& part, std::size_t first, std::size_t count,
                           QueryBatch& batch) const {
  batch.clear();
  const double width = parameters_.buffer.value_or(std::numeric_limits<double>::infinity());
  for (std::size_t i = first; i < first + count; ++i) {
    const Support support = narrowed(support_of(part, i), parameters_.method.weight, width);
    if (!part.excluded.empty() && part.excluded[i])
      batch.add(Status::kExcluded);
    else if (support.radius <= 0)
      batch.add(parameters_.nearest ? Status::kIsolated : Status::kTooFew);
    else
      batch.add(part.own[i], support);
  }
}

void ProjectOperator::place(Projection& projection, Part& part, std::size_t i) const {
  if (!parameters_.only_normals) part.own[i] = destination(projection, part.own[i]);
  if (bytes_per_row() > 0) columns_.write(projection, &part.rows[i * bytes_per_row()]);
}

Index3 ProjectOperator::destination(Projection& projection, const Index3& own) const {
  Index3 stays = own;
  for (std::int64_t& coordinate : stays) coordinate *= refinement_;
  if (!moved(projection.status)) return stays;
  Index3 place = stays;
  for (std::size_t a = 0; a < 3; ++a)
    place[a] += std::llrint(projection.displacement[a] / header_.lattice.scale[a]);
  if (representable(place)) return place;
  projection.status = Status::kNotRepresentable;
  projection.displacement = {};
  return stays;
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

void ProjectOperator::merge_note(std::vector<std::byte>& total,
                                 std::span<const std::byte> next) const {
  ProjectStatistics sum = ProjectStatistics::from_bytes(total);
  sum.add(ProjectStatistics::from_bytes(next));
  total = sum.to_bytes();
}

}  // namespace pss
