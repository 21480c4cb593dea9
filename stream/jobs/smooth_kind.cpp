#include "stream/jobs/smooth_kind.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "stream/jobs/attributes.h"
#include "stream/jobs/calibration.h"
#include "stream/jobs/parameters_json.h"
#include "stream/jobs/smooth_method.h"
#include "stream/widths/width_trials.h"
#include "stream/widths/widths_json.h"

namespace pss {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* kNormalsPass = "normals";
constexpr const char* kProjection = "smooth";
constexpr double kUsualNeighbours = 113;  ///< at h = 2 spacings

/// The reach where it is known before any point is read.
std::optional<double> known_reach(const SmoothOptions& options, const Method& method) {
  if (needs_spacing(options.widths) || options.widths.knn) return std::nullopt;
  const ChosenWidths chosen = choose_widths(options.widths, method, std::nullopt);
  return reach(options.weight, {chosen.h, chosen.radius});
}

/// Refuses a buffer by hand that is less than `needed`.
Result<void> check_buffer(const SmoothOptions& options, double needed) {
  if (!options.buffer || options.allow_inexact || *options.buffer >= needed) return {};
  return Error{
      Fault::kUsage,
      fmt::format("--buffer {} is less than the {:.6g} that exactness needs; leave it out, "
                  "or add --allow-inexact",
                  *options.buffer, needed)};
}

/// Neighbours of a point on a surface of the measured spacing.
double usual_neighbours(const ChosenWidths& widths) {
  if (widths.neighbours > 0) return widths.neighbours;
  if (widths.nearest) return widths.nearest * widths.factor * widths.factor;
  if (!widths.spacing || widths.radius <= 0) return kUsualNeighbours;
  const double r = widths.radius / widths.spacing->spacing;
  return std::numbers::pi * r * r;
}

Pass pass_of(const char* name, std::unique_ptr<const PassSource> source, ProjectOperator op) {
  return {.name = name,
          .queries = std::move(source),
          .op = std::make_unique<ProjectOperator>(std::move(op))};
}

}  // namespace

SmoothKind::SmoothKind(const SmoothJob& job) : job_(job) {
  choices_.method = method_of(job.options);
}

json SmoothKind::parameters() const {
  const SmoothOptions& options = job_.options;
  const Method& method = choices_.method;
  json parameters = {{"operator", name_of(method.op)},
                     {"weight", name_of(method.weight)},
                     {"precision", name_of(method.precision)},
                     {"radius", optional_json(options.widths.radius)},
                     {"h", optional_json(options.widths.h)},
                     {"knn", optional_json(options.widths.knn)},
                     {"polynomial-order", needs_normals(method.op) ? json() : json(method.degree)},
                     {"outputs", output_names(options.outputs)},
                     {"replace-attributes", options.replace_attributes},
                     {"buffer", optional_json(options.buffer)},
                     {"allow-inexact", options.allow_inexact}};
  add_grid_json(job_, parameters);
  return parameters;
}

PassNames SmoothKind::passes() const {
  if (!needs_normals(choices_.method.op)) return {{kProjection}};
  return {{kNormalsPass, kProjection}};
}

Result<void> SmoothKind::check() const {
  const SmoothOptions& options = job_.options;
  PSS_TRY(check_widths(options.widths));
  if (options.buffer && !(*options.buffer >= 0 && std::isfinite(*options.buffer)))
    return Error{Fault::kUsage,
                 fmt::format("--buffer: found {}, expected a length", *options.buffer)};
  if (options.allow_inexact && !options.buffer)
    return Error{Fault::kUsage,
                 "--allow-inexact has no meaning without --buffer; leave it out, or give both"};
  return check_buffer(options, known_reach(options, choices_.method).value_or(0));
}

Result<void> SmoothKind::check_source(const Schema& source) const {
  if (job_.options.replace_attributes) return {};
  return check_clashes(job_, source, job_.options.outputs);
}

Result<Schema> SmoothKind::result_schema(const Schema& source) const {
  Schema schema = source;
  PSS_TRY(OutputColumns::add_to(schema, job_.options.outputs));
  return schema;
}

std::uint64_t SmoothKind::measuring_memory() const {
  return needs_spacing(job_.options.widths) ? width_memory() : 0;
}

Result<std::optional<Pass>> SmoothKind::next(PassContext& job) {
  if (job.done.empty()) {
    PSS_ASSIGN(Pass pass, first(job));
    return std::optional(std::move(pass));
  }
  if (job.done.back().name == kProjection) return std::optional<Pass>();
  PSS_ASSIGN(std::unique_ptr<PassSource> source, job.open_input());
  PSS_TRY(job.join(*source, kNormalsPass));
  PSS_ASSIGN(Pass pass, projection(std::move(source), job));
  return std::optional(std::move(pass));
}

/// Chooses the widths; then the projection itself, or the normals that it needs.
Result<Pass> SmoothKind::first(PassContext& job) {
  PSS_ASSIGN(std::unique_ptr<PassSource> source, job.open_input());
  PSS_TRY(choose_widths_for(source->points(), job));
  choices_.normals = normals_from(source->points().schema(), choices_.method);
  PSS_ASSIGN(Pass last, projection(std::move(source), job));
  if (choices_.normals != NormalsFrom::kFirstPass) return last;
  const StoreShape result = shape_of(*last.op);
  last.op.reset();  // one operator at a time has a header
  PSS_ASSIGN(ProjectOperator op, normals_of(last.source(), job));
  Pass pass = pass_of(kNormalsPass, std::move(last.queries), std::move(op));
  pass.largest_move = largest_move();
  pass.later = {result};
  return pass;
}

Result<void> SmoothKind::choose_widths_for(const Source& source, PassContext& job) {
  const StageTimer timer("spacing", job.report.stages);
  PSS_ASSIGN(choices_.widths,
             choose_widths(source, job_.options.widths, choices_.method, job.budget, job.monitor));
  job.monitor.note(choices_.widths.why);
  return {};
}

/// How wide every pass looks.
ProjectParameters SmoothKind::parameters_for(const PassContext& job) const {
  const ChosenWidths& widths = choices_.widths;
  ProjectParameters parameters;
  parameters.support = {widths.h, widths.radius};
  parameters.nearest = widths.nearest;
  parameters.factor = widths.factor;
  parameters.cap = widths.cap;
  parameters.first_guess = widths.typical;
  parameters.buffer = job_.options.buffer;
  // Numbers and names alone: a resumed job finds its result by them, and no sentence is compared.
  ordered_json record = method_json(choices_.method);
  record["radius"] = widths.radius;
  record["h"] = widths.h;
  record["knn"] = widths.nearest;
  record["radius_per_distance"] = widths.factor;
  record["cap"] = widths.cap;
  parameters.record = owned_by(job.identity, std::move(record));
  return parameters;
}

Result<ProjectOperator> SmoothKind::normals_of(const Source& source, const PassContext& job) const {
  ProjectParameters parameters = parameters_for(job);
  parameters.method = normals_method(choices_.method);
  parameters.only_normals = true;
  return ProjectOperator::create(source, parameters);
}

Result<ProjectOperator> SmoothKind::projection_of(const Source& source,
                                                  const PassContext& job) const {
  ProjectParameters parameters = parameters_for(job);
  parameters.method = choices_.method;
  parameters.outputs = job_.options.outputs;
  PSS_ASSIGN(const Format* file, sink_of(job_));
  if (file && file->integer_grid)
    parameters.grid = export_grid(source.header(), world_bounds_of(source.store()), largest_move(),
                                  export_options(job_));
  return ProjectOperator::create(source, parameters);
}

Result<Pass> SmoothKind::projection(std::unique_ptr<const PassSource> source,
                                    const PassContext& job) const {
  PSS_ASSIGN(ProjectOperator op, projection_of(source->points(), job));
  PSS_TRY(check_buffer(job_.options, op.neighbourhood().largest_reach()));
  Pass pass = pass_of(kProjection, std::move(source), std::move(op));
  pass.largest_move = largest_move();
  return pass;
}

double SmoothKind::largest_move() const {
  return std::max(choices_.widths.radius, choices_.widths.cap);
}

void SmoothKind::remember(ordered_json& summary) const {
  summary["normals"] = name_of(choices_.normals);
  summary["widths"] = widths_json(choices_.widths);
}

void SmoothKind::recall(const ordered_json& summary) {
  choices_.normals = normals_named(summary.value("normals", ""));
  choices_.widths = widths_from_json(summary.value("widths", ordered_json::object()));
}

/// Widths that reach too few neighbours, or too many, leave most points where they are.
Result<void> SmoothKind::look_at(const Store& result, JobReport& report) {
  PSS_ASSIGN(statistics_, ProjectStatistics::from_note(result.note(), result.path()));
  const std::uint64_t moved = statistics_.moved();
  if (2 * moved >= result.points()) return {};
  report.notes.push_back(fmt::format(
      "only {} of {} points moved; the status says why, --radius, --h and --knn decide it", moved,
      result.points()));
  return {};
}

std::vector<StoreShape> SmoothKind::expect(const StoreHeader& source) {
  const WidthOptions& options = job_.options.widths;
  choices_.widths = choose_widths(options, choices_.method, std::nullopt);
  if (needs_spacing(options))
    choices_.widths.why = "spacing and noise are measured once the points are sorted";
  choices_.normals = normals_from(source.schema, choices_.method);
  std::vector<StoreShape> shapes;
  if (choices_.normals == NormalsFrom::kFirstPass)
    shapes.push_back({source.lattice, sizeof(Normal), true});
  const Result<Schema> schema = result_schema(source.schema);
  shapes.push_back({source.grid ? refined_lattice(source.lattice, {}, 0) : source.lattice,
                    (schema ? *schema : source.schema).row_size()});
  return shapes;
}

double SmoothKind::seconds_per_point() const {
  const double neighbours = usual_neighbours(choices_.widths);
  const double projecting = pss::seconds_per_point(choices_.method, neighbours);
  if (choices_.normals != NormalsFrom::kFirstPass) return projecting;
  return projecting + pss::seconds_per_point(normals_method(choices_.method), neighbours);
}

}  // namespace pss
