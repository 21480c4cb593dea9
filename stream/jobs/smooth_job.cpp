#include "stream/jobs/smooth_job.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "io/file/fingerprint.h"
#include "io/formats/table.h"
#include "io/inputs.h"
#include "io/open.h"
#include "stream/jobs/smooth_json.h"
#include "stream/jobs/smooth_method.h"

namespace pss {
namespace {

using nlohmann::json;

template <class T>
json optional_json(const std::optional<T>& value) {
  return value ? json(*value) : json();
}

json box_json(const std::optional<WorldBox>& box) {
  return box ? json{box->min, box->max} : json();
}

/// What the result depends on beside the sorted input, by the names of the flags.
json parameters_of(const SmoothJob& job) {
  const SmoothOptions& options = job.options;
  const Method method = method_of(options);
  return {{"operator", name_of(method.op)},
          {"weight", name_of(method.weight)},
          {"precision", name_of(method.precision)},
          {"radius", optional_json(options.widths.radius)},
          {"h", optional_json(options.widths.h)},
          {"knn", optional_json(options.widths.knn)},
          {"polynomial-order", needs_normals(method.op) ? json() : json(method.degree)},
          {"outputs", output_names(options.outputs)},
          {"replace-attributes", options.replace_attributes},
          {"buffer", optional_json(options.buffer)},
          {"allow-inexact", options.allow_inexact},
          {"scale", options.scale_auto ? json("auto") : optional_json(options.scale)},
          {"offset", optional_json(options.offset)}};
}

/// The reach where it is known before any point is read.
std::optional<double> known_reach(const SmoothOptions& options) {
  const WidthOptions& widths = options.widths;
  if (needs_spacing(widths) || widths.knn) return std::nullopt;
  const ChosenWidths chosen = choose_widths(widths, method_of(options), std::nullopt);
  return reach(options.weight, {chosen.h, chosen.radius});
}

/// Refuses a buffer by hand that is less than `needed`.
Result<void> check_buffer_width(const SmoothOptions& options, double needed) {
  if (!options.buffer || options.allow_inexact || *options.buffer >= needed) return {};
  return Error{
      Fault::kUsage,
      fmt::format("--buffer {} is less than the {:.6g} that exactness needs; leave it out, "
                  "or add --allow-inexact",
                  *options.buffer, needed)};
}

/// How wide every pass of the job looks.
ProjectParameters parameters_for(const SmoothJob& job, const ChosenWidths& widths,
                                 const std::string& identity) {
  ProjectParameters parameters;
  parameters.support = {widths.h, widths.radius};
  parameters.nearest = widths.nearest;
  parameters.factor = widths.factor;
  parameters.cap = widths.cap;
  parameters.first_guess = widths.typical;
  parameters.buffer = job.options.buffer;
  parameters.record = result_parameters(job, widths, identity);
  return parameters;
}

/// Refuses an output of no known format, and a grid for one that has none.
Result<void> check_format(const SmoothJob& job) {
  const SmoothOptions& options = job.options;
  const Format* format = nullptr;
  if (!is_store_name(job.output)) {
    PSS_ASSIGN(format, format_for(job.output));
  }
  return check_grid_options(job.output, format, options.scale || options.scale_auto,
                            options.offset.has_value());
}
/// No point moves farther than it looks.
double room_for_moves(const ChosenWidths& widths) { return std::max(widths.radius, widths.cap); }

bool positive(const World3& v) {
  return std::ranges::all_of(v, [](double x) { return x > 0 && std::isfinite(x); });
}

}  // namespace

Result<void> check_job(const SmoothJob& job) {
  const SmoothOptions& options = job.options;
  PSS_TRY(check_widths(options.widths));
  if (job.inputs.empty()) return Error{Fault::kUsage, "no input given"};
  PSS_TRY(check_output(job.inputs, job.output));
  PSS_TRY(check_format(job));
  if (options.buffer && !(*options.buffer >= 0 && std::isfinite(*options.buffer)))
    return Error{Fault::kUsage,
                 fmt::format("--buffer: found {}, expected a length", *options.buffer)};
  if (options.allow_inexact && !options.buffer)
    return Error{Fault::kUsage,
                 "--allow-inexact has no meaning without --buffer; leave it out, or give both"};
  PSS_TRY(check_buffer_width(options, known_reach(options).value_or(0)));
  if (options.scale && !positive(*options.scale))
    return Error{Fault::kUsage, "--scale: expected lengths above zero"};
  if (options.tile_points == 0) return Error{Fault::kUsage, "--tile-points: expected at least 1"};
  if (options.drop_outside && is_store_input(job))
    return Error{Fault::kUsage,
                 fmt::format("--drop-outside: {} is a store, whose points are sorted already; give "
                             "the option to the pss tile that makes it",
                             job.inputs.front())};
  for (const std::string& input : job.inputs)
    if (is_store_name(input) && job.inputs.size() > 1)
      return Error{Fault::kUsage, fmt::format("{}: a store must be the only input; found {} inputs",
                                              input, job.inputs.size())};
  return {};
}

bool is_store_input(const SmoothJob& job) {
  return job.inputs.size() == 1 && is_store_name(job.inputs.front());
}

bool is_complete_store(const std::string& path) {
  if (!is_store(path)) return false;
  const Result<Store> store = Store::open(path);
  return store && store->complete() && exists(manifest_path(path));
}

JobPlaces places_of(const SmoothJob& job) {
  const SmoothOptions& options = job.options;
  return {job.inputs,        job.output,      options.work_dir, options.state_folder,
          options.overwrite, options.restart, options.keep_work};
}

Result<JobRecord> job_record(const SmoothJob& job) {
  JobRecord record;
  record.command = "smooth";
  record.output = job.output;
  record.sorting = json{{"tile-points", job.options.tile_points},
                        {"drop-outside", box_json(job.options.drop_outside)}}
                       .dump();
  record.parameters = parameters_of(job).dump();
  for (const std::string& input : job.inputs) {
    const std::string file = is_store_input(job) ? manifest_path(input) : input;
    PSS_ASSIGN(InputRecord found, settled_fingerprint(file));
    record.inputs.push_back(std::move(found));
  }
  return record;
}

ExportOptions export_options(const SmoothJob& job) {
  const SmoothOptions& options = job.options;
  return {.scale = options.scale,
          .scale_auto = options.scale_auto,
          .offset = options.offset,
          .rules = {},
          .checked = true};  // by check_output_grid(), before any point is moved
}

IngestOptions ingest_options(const SmoothJob& job) {
  IngestOptions options;
  options.tile_points = job.options.tile_points;
  options.drop_outside = job.options.drop_outside;
  const Format* format = format_by_extension(job.output);
  if (format && format->integer_grid) options.gridded_output = export_options(job);
  return options;
}

Result<void> check_output_box(const Store& source, const SmoothJob& job) {
  if (is_store_name(job.output)) return {};
  PSS_ASSIGN(const Format* format, format_for(job.output));
  return check_export_box(source, 0, *format, export_options(job));
}

Result<std::string> check_output_grid(const Store& source, const SmoothJob& job,
                                      const ChosenWidths& widths, Monitor& monitor) {
  if (is_store_name(job.output)) return std::string();
  PSS_ASSIGN(const Format* format, format_for(job.output));
  const double room = room_for_moves(widths);
  const ExportOptions options = export_options(job);
  if (is_store_input(job)) return check_export(source, room, *format, options, monitor);
  return check_export(source, room, *format, options, monitor, "leave such points out with");
}

Result<ProjectOperator> project_operator(const Source& source, const SmoothJob& job,
                                         const ChosenWidths& widths, const std::string& identity) {
  ProjectParameters parameters = parameters_for(job, widths, identity);
  parameters.method = method_of(job.options);
  parameters.outputs = job.options.outputs;
  if (!is_store_name(job.output)) {
    PSS_ASSIGN(const Format* format, format_for(job.output));
    if (format->integer_grid)
      parameters.grid = export_grid(source.header(), world_bounds_of(source.store()),
                                    room_for_moves(widths), export_options(job));
  }
  return ProjectOperator::create(source, parameters);
}

Result<ProjectOperator> normals_operator(const Source& source, const SmoothJob& job,
                                         const ChosenWidths& widths, const std::string& identity) {
  ProjectParameters parameters = parameters_for(job, widths, identity);
  parameters.method = normals_method(method_of(job.options));
  parameters.only_normals = true;
  return ProjectOperator::create(source, parameters);
}

Result<void> check_buffer(const ProjectOperator& op, const SmoothOptions& options) {
  return check_buffer_width(options, op.neighbourhood().largest_reach());
}

}  // namespace pss
