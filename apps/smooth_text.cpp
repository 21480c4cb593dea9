#include "apps/smooth_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "apps/estimate_text.h"
#include "apps/ingest_text.h"
#include "apps/progress_view.h"
#include "core/status.h"

namespace pss {

namespace {

std::string widths_text(const ChosenWidths& widths) {
  if (widths.nearest > 0)
    return fmt::format(
        "radius of each point: {:.4g} x the distance to neighbour {}, at most {:.6g}",
        widths.factor, widths.nearest, widths.cap);
  return fmt::format("h {:.6g}, radius {:.6g}", widths.h, widths.radius);
}

std::string method_text(const SmoothChoices& choices) {
  const Method& method = choices.method;
  const NormalsFrom normals = choices.normals;
  const std::string order =
      needs_normals(method.op) ? "" : fmt::format(" of order {}", method.degree);
  const std::string source =
      normals == NormalsFrom::kNowhere ? "" : fmt::format(", normals {}", name_of(normals));
  return fmt::format("{}{}, {} weight, {} precision{}", name_of(method.op), order,
                     name_of(method.weight), name_of(method.precision), source);
}

/// Empty where no point asked for it.
std::string redone_text(const ProjectStatistics& statistics) {
  if (statistics.redone == 0) return {};
  return fmt::format("; redone in double {:.2g}%", 100 * statistics.redone_share());
}

std::string statuses_text(const ProjectStatistics& statistics) {
  std::string text;
  for (int code = 0; code < kStatusCount; ++code) {
    const std::uint64_t count = statistics.statuses[static_cast<std::size_t>(code)];
    if (count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", status_name(static_cast<Status>(code)),
                        grouped(count));
  }
  if (statistics.second_sheet > 0)
    text += fmt::format("; second sheet near {}", grouped(statistics.second_sheet));
  return text;
}

/// "sort 0.1, spacing 0.4, smooth 3.1, write 0.1": the stages of this run.
std::string stages_text(const JobReport& report) {
  std::string text;
  for (const StageReport& stage : report.stages)
    if (stage.name != "plan")
      text += fmt::format("{}{} {:.1f}", text.empty() ? "" : ", ", stage.name, stage.seconds);
  return text;
}

double rate(std::uint64_t points, double seconds) {
  return seconds > 0 ? static_cast<double>(points) / seconds : 0;
}

}  // namespace

std::vector<std::string> summary_lines(const SmoothReport& report) {
  if (report.already_complete) return {fmt::format("{}: already complete", report.output)};
  std::vector<std::string> lines = report.notes;
  const ProjectStatistics& statistics = report.statistics;
  std::ranges::copy(ingest_lines(report.ingest), std::back_inserter(lines));
  lines.push_back(method_text(report.choices) + redone_text(statistics));
  lines.push_back(widths_text(report.choices.widths));
  lines.push_back(fmt::format("neighbours {:.1f} a point; moved by {:.4g} rms, {:.4g} at most",
                              statistics.mean_neighbours(), statistics.rms_displacement(),
                              statistics.largest_displacement));
  lines.push_back("status: " + statuses_text(statistics));
  lines.push_back(fmt::format("time {:.1f} s ({}); peak memory {} of {}", report.total_seconds,
                              stages_text(report), short_size(report.peak_memory),
                              short_size(report.memory_limit)));
  lines.push_back(fmt::format(
      "{}: {} points, {} points/s; tiles {}", report.output, grouped(report.points_out),
      short_count(rate(report.points_out, report.total_seconds)), grouped(report.tiles)));
  return lines;
}

std::string estimate_text(const SmoothEstimate& estimate) {
  std::string text = estimate_text(static_cast<const JobEstimate&>(estimate));
  text += estimate_line("method", method_text(estimate.choices));
  if (estimate.from_store) text += estimate_line("widths", widths_text(estimate.choices.widths));
  return text;
}

}  // namespace pss
