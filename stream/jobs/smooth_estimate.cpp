// What a smoothing job would take: `--dry-run`.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "stream/jobs/calibration.h"
#include "stream/jobs/output_clash.h"
#include "stream/jobs/smooth.h"
#include "stream/jobs/smooth_job.h"
#include "stream/jobs/smooth_memory.h"
#include "stream/jobs/smooth_method.h"
#include "stream/jobs/smooth_space.h"
#include "stream/sort/chunk.h"
#include "stream/sort/disk_need.h"

namespace pss {
namespace {

constexpr double kUsualTilePoints = kTilePoints / 1.7;  ///< between a full tile and a quarter of it
constexpr double kUsualNeighbours = 113;                ///< at h = 2 spacings
constexpr double kSortRate = 1.5e6;                     ///< points/s a core to read, sort and write
constexpr double kRowWork = 1.2;  ///< loading, compressing and committing, beside the projection

/// Neighbours of a point on a surface of this spacing.
double usual_neighbours(const ChosenWidths& widths) {
  if (widths.neighbours > 0) return widths.neighbours;
  if (widths.nearest) {
    const double k = widths.nearest;
    return k * widths.factor * widths.factor;
  }
  if (!widths.spacing || widths.radius <= 0) return kUsualNeighbours;
  const double r = widths.radius / widths.spacing->spacing;
  return std::numbers::pi * r * r;
}

void add_times(SmoothEstimate& estimate, double neighbours) {
  const double points = static_cast<double>(estimate.points);
  const double threads = thread_count();
  double per_point = seconds_per_point(estimate.method, neighbours);
  if (estimate.normals == NormalsFrom::kFirstPass)
    per_point += seconds_per_point(normals_method(estimate.method), neighbours);
  estimate.seconds = kRowWork * points * per_point / threads;
  if (!estimate.from_store) estimate.seconds += points / kSortRate / std::min(threads, 4.0);
}

Result<SmoothEstimate> from_store(const SmoothJob& job, MemoryBudget& budget, Monitor& monitor) {
  PSS_ASSIGN(const Store source, Store::open(job.inputs.front()));
  PSS_TRY(check_attributes(job, source.header()));
  SmoothEstimate estimate;
  estimate.method = method_of(job.options);
  estimate.normals = normals_from(source.header().schema, estimate.method);
  PSS_ASSIGN(estimate.widths,
             choose_widths(source, job.options.widths, estimate.method, budget, monitor));
  PSS_ASSIGN(const ProjectOperator op, project_operator(source, job, estimate.widths, ""));
  PSS_TRY(check_buffer(op, job.options));
  PSS_TRY(check_output_grid(source, job, estimate.widths, monitor));
  PSS_ASSIGN(const ScheduleEstimate schedule, estimate_operator(Source(source), op, budget));
  estimate.from_store = true;
  estimate.points = source.points();
  estimate.tiles = schedule.tiles;
  estimate.parts = schedule.parts;
  if (schedule.own_points)
    estimate.halo_share =
        static_cast<double>(schedule.halo_points) / static_cast<double>(schedule.own_points);
  estimate.peak_memory = budget.limit() - budget.total() + schedule.peak_bytes;
  estimate.disk_bytes = smooth_space(job, estimate.normals, source, op).most();
  add_times(estimate, usual_neighbours(estimate.widths));
  return estimate;
}

/// Sorting takes what it gets, up to all points at once; a tile and the next take theirs.
std::uint64_t peak_from_files(std::uint64_t points, std::size_t row, const MemoryBudget& budget) {
  const std::uint64_t sorting = points * (2 * row + 64);
  const std::uint64_t tiles = 2 * std::min<std::uint64_t>(points, kTilePoints) * (2 * row + 100);
  return budget.limit() - budget.total() + std::min(budget.total(), std::max(sorting, tiles));
}

/// From a compressed sample of the inputs.
Result<std::uint64_t> disk_from_files(const SmoothJob& job, const IngestPlan& plan,
                                      std::size_t result_row, NormalsFrom normals,
                                      const MemoryBudget& budget, const Monitor& monitor) {
  const std::size_t row = plan.header.schema.row_size();
  const std::uint64_t most_sampled = budget.total() / (4 * Chunk::bytes_per_point(row));
  PSS_ASSIGN(const double per_point, sample_bytes(plan, false, most_sampled, monitor));
  const auto bytes = static_cast<std::uint64_t>(per_point * static_cast<double>(plan.points));
  const Lattice& lattice = plan.header.lattice;
  const Lattice refined = plan.header.grid ? refined_lattice(lattice, {}, 0) : lattice;
  return smooth_space(job, normals, {plan.points, bytes, lattice, row}, refined, result_row).most();
}

Result<SmoothEstimate> from_files(const SmoothJob& job, MemoryBudget& budget, Monitor& monitor) {
  const IngestOptions options = ingest_options(job);
  PSS_ASSIGN(const IngestPlan plan, plan_ingest(job.inputs, options, monitor));
  PSS_TRY(check_attributes(job, plan.header));
  Schema schema = plan.header.schema;
  PSS_TRY(OutputColumns::add_to(schema, job.options.outputs));
  SmoothEstimate estimate;
  estimate.method = method_of(job.options);
  estimate.normals = normals_from(plan.header.schema, estimate.method);
  estimate.points = plan.points;
  const double per_tile = kUsualTilePoints * job.options.tile_points / kTilePoints;
  estimate.tiles = static_cast<std::uint64_t>(static_cast<double>(plan.points) / per_tile) + 1;
  estimate.parts = estimate.tiles;
  estimate.widths = choose_widths(job.options.widths, estimate.method, std::nullopt);
  if (needs_spacing(job.options.widths))
    estimate.widths.why = "spacing and noise are measured once the points are sorted";
  // Perimeter over area of a square tile, at the default reach of 7 spacings.
  estimate.halo_share = 4 * 7 / std::sqrt(std::max(1.0, per_tile));
  estimate.peak_memory = peak_from_files(plan.points, schema.row_size(), budget);
  PSS_ASSIGN(estimate.disk_bytes,
             disk_from_files(job, plan, schema.row_size(), estimate.normals, budget, monitor));
  add_times(estimate, kUsualNeighbours);
  return estimate;
}

}  // namespace

Result<SmoothEstimate> estimate_smooth(const SmoothJob& job, MemoryBudget& budget,
                                       Monitor& monitor) {
  PSS_TRY(check_job(job));
  PSS_TRY(check_places(places_of(job)));
  PSS_ASSIGN(const Reservation inputs, reserve_inputs(job, budget));
  return is_store_input(job) ? from_store(job, budget, monitor) : from_files(job, budget, monitor);
}

}  // namespace pss
