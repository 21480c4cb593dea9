#include "stream/jobs/job_estimate.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/parallel.h"
#include "stream/jobs/attributes.h"
#include "stream/jobs/job_memory.h"
#include "stream/jobs/job_space.h"
#include "stream/jobs/run_job.h"
#include "stream/sort/chunk.h"
#include "stream/sort/disk_need.h"

namespace pss {
namespace {

constexpr double kUsualTilePoints = kTilePoints / 1.7;  ///< between a full tile and a quarter of it
constexpr double kSortRate = 1.5e6;                     ///< points/s a core to read, sort and write
constexpr double kRowWork = 1.2;  ///< loading, compressing and committing, beside the computation

double seconds_for(const JobEstimate& estimate, const JobKind& kind) {
  const double points = static_cast<double>(estimate.points);
  const double threads = thread_count();
  const double computing = kRowWork * points * kind.seconds_per_point() / threads;
  return estimate.from_store ? computing : computing + points / kSortRate / std::min(threads, 4.0);
}

std::uint64_t program_memory(const MemoryBudget& budget) { return budget.limit() - budget.total(); }

void add_schedule(JobEstimate& estimate, const ScheduleEstimate& schedule,
                  const MemoryBudget& budget) {
  estimate.tiles = schedule.tiles;
  estimate.parts = schedule.parts;
  if (schedule.own_points)
    estimate.halo_share =
        static_cast<double>(schedule.halo_points) / static_cast<double>(schedule.own_points);
  estimate.peak_memory = program_memory(budget) + schedule.peak_bytes;
}

Result<JobEstimate> from_store(const JobRequest& request, JobKind& kind, MemoryBudget& budget,
                               Monitor& monitor) {
  JobReport report;
  PassContext context{.request = request,
                      .kind = kind,
                      .work_dir = {},
                      .inputs = {},
                      .identity = {},
                      .budget = budget,
                      .monitor = monitor,
                      .report = report};
  PSS_ASSIGN(const std::optional<Pass> first, kind.next(context));
  JobEstimate estimate;
  estimate.from_store = true;
  if (!first) return estimate;
  const Store& source = first->source().store();
  PSS_TRY(check_output_grid(source, request, first->largest_move, monitor));
  estimate.points = source.points();
  PSS_ASSIGN(const ScheduleEstimate schedule,
             estimate_operator(first->sources(), *first->op, budget));
  add_schedule(estimate, schedule, budget);
  std::vector<StoreShape> shapes{shape_of(*first->op)};
  shapes.insert(shapes.end(), first->later.begin(), first->later.end());
  estimate.disk_bytes = job_space(request, stored_points(source), shapes).most();
  estimate.seconds = seconds_for(estimate, kind);
  return estimate;
}

/// Sorting takes what it gets, up to all points at once; a tile and the next take theirs.
std::uint64_t peak_from_files(std::uint64_t points, std::size_t row, const MemoryBudget& budget) {
  const std::uint64_t sorting = points * (2 * row + 64);
  const std::uint64_t tiles = 2 * std::min<std::uint64_t>(points, kTilePoints) * (2 * row + 100);
  return program_memory(budget) + std::min(budget.total(), std::max(sorting, tiles));
}

/// What the plan's points will take once they are sorted, from a compressed sample of the inputs.
Result<StoredPoints> sorted_points(const IngestPlan& plan, const MemoryBudget& budget,
                                   const Monitor& monitor) {
  const StoreShape shape = shape_of(plan.header);
  const std::uint64_t most_sampled = budget.total() / (4 * Chunk::bytes_per_point(shape.row_bytes));
  PSS_ASSIGN(const double per_point, sample_bytes(plan, false, most_sampled, monitor));
  const auto bytes = static_cast<std::uint64_t>(per_point * static_cast<double>(plan.points));
  return StoredPoints{plan.points, bytes, shape};
}

Result<JobEstimate> from_files(const JobRequest& request, JobKind& kind, MemoryBudget& budget,
                               Monitor& monitor) {
  PSS_ASSIGN(const IngestOptions options, ingest_options(request, kind));
  PSS_ASSIGN(const IngestPlan plan, plan_ingest(request.inputs, options, monitor));
  PSS_TRY(check_attributes(request, kind, plan.header));
  PSS_ASSIGN(const Schema result, kind.result_schema(plan.header.schema));
  const std::vector<StoreShape> shapes = kind.expect(plan.header);
  JobEstimate estimate;
  estimate.points = plan.points;
  const double per_tile = kUsualTilePoints * request.tile_points / kTilePoints;
  estimate.tiles = static_cast<std::uint64_t>(static_cast<double>(plan.points) / per_tile) + 1;
  estimate.parts = estimate.tiles;
  // Perimeter over area of a square tile, at the default reach of 7 spacings.
  estimate.halo_share = 4 * 7 / std::sqrt(std::max(1.0, per_tile));
  estimate.peak_memory = peak_from_files(plan.points, result.row_size(), budget);
  PSS_ASSIGN(const StoredPoints sorted, sorted_points(plan, budget, monitor));
  estimate.disk_bytes = job_space(request, sorted, shapes).most();
  estimate.seconds = seconds_for(estimate, kind);
  return estimate;
}

}  // namespace

Result<JobEstimate> estimate_job(const JobRequest& request, JobKind& kind, MemoryBudget& budget,
                                 Monitor& monitor) {
  PSS_TRY(kind.check());
  PSS_TRY(check_request(request));
  PSS_TRY(check_places(request));
  PSS_ASSIGN(const Reservation inputs, reserve_inputs(request, kind, budget));
  return is_store_input(request) ? from_store(request, kind, budget, monitor)
                                 : from_files(request, kind, budget, monitor);
}

nlohmann::ordered_json estimate_json(std::string_view command, const JobEstimate& estimate) {
  return {{"command", command},
          {"dry_run", true},
          {"from_store", estimate.from_store},
          {"points", estimate.points},
          {"tiles", estimate.tiles},
          {"parts", estimate.parts},
          {"halo_share", estimate.halo_share},
          {"memory", {{"peak", estimate.peak_memory}}},
          {"disk_bytes", estimate.disk_bytes},
          {"seconds", estimate.seconds}};
}

}  // namespace pss
