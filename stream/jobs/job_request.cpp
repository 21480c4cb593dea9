#include "stream/jobs/job_request.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "io/inputs.h"
#include "io/open.h"

namespace pss {
namespace {

bool positive(const World3& v) {
  return std::ranges::all_of(v, [](double x) { return x > 0 && std::isfinite(x); });
}

/// A store is sorted already, so that it can neither be mixed with others nor thinned by a box.
Result<void> check_stores(const JobRequest& request) {
  if (request.drop_outside && is_store_input(request))
    return Error{Fault::kUsage,
                 fmt::format("--drop-outside: {} is a store, whose points are sorted already; give "
                             "the option to the pss tile that makes it",
                             request.inputs.front())};
  for (const std::string& input : request.inputs)
    if (is_store_name(input) && request.inputs.size() > 1)
      return Error{Fault::kUsage, fmt::format("{}: a store must be the only input; found {} inputs",
                                              input, request.inputs.size())};
  return {};
}

}  // namespace

Result<void> check_request(const JobRequest& request) {
  if (request.inputs.empty()) return Error{Fault::kUsage, "no input given"};
  PSS_TRY(check_output(request.inputs, request.output));
  PSS_ASSIGN(const Format* format, sink_of(request));
  PSS_TRY(check_grid_options(request.output, format, request.scale || request.scale_auto,
                             request.offset.has_value()));
  if (request.scale && !positive(*request.scale))
    return Error{Fault::kUsage, "--scale: expected lengths above zero"};
  if (request.tile_points == 0) return Error{Fault::kUsage, "--tile-points: expected at least 1"};
  return check_stores(request);
}

bool is_store_input(const JobRequest& request) {
  return request.inputs.size() == 1 && is_store_name(request.inputs.front());
}

Result<const Format*> sink_of(const JobRequest& request) {
  if (is_store_name(request.output)) return static_cast<const Format*>(nullptr);
  return format_for(request.output);
}

ExportOptions export_options(const JobRequest& request) {
  return {.scale = request.scale,
          .scale_auto = request.scale_auto,
          .offset = request.offset,
          .rules = {},
          .checked = true};  // by check_output_grid(), before any point is moved
}

Result<void> check_output_box(const Store& source, const JobRequest& request) {
  PSS_ASSIGN(const Format* format, sink_of(request));
  if (!format) return {};
  return check_export_box(source, 0, *format, export_options(request));
}

Result<std::string> check_output_grid(const Store& source, const JobRequest& request,
                                      double largest_move, Monitor& monitor) {
  PSS_ASSIGN(const Format* format, sink_of(request));
  if (!format) return std::string();
  const ExportOptions options = export_options(request);
  if (is_store_input(request)) return check_export(source, largest_move, *format, options, monitor);
  return check_export(source, largest_move, *format, options, monitor,
                      "leave such points out with");
}

}  // namespace pss
