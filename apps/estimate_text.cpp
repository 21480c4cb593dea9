#include "apps/estimate_text.h"

#include <fmt/format.h>

#include "apps/progress_view.h"
#include "apps/standard_streams.h"

namespace pss {

std::string estimate_line(const char* name, const std::string& value) {
  return fmt::format("{:<16} {}\n", name, value);
}

std::string estimate_text(const JobEstimate& estimate) {
  return estimate_line("points", grouped(estimate.points)) +
         estimate_line("tiles", grouped(estimate.tiles)) +
         estimate_line("parts", grouped(estimate.parts)) +
         estimate_line("halo",
                       fmt::format("at most {:.0f}% of the points", estimate.halo_share * 100)) +
         estimate_line("peak memory", short_size(estimate.peak_memory)) +
         estimate_line("disk", short_size(estimate.disk_bytes)) +
         estimate_line("time", short_time(estimate.seconds)) +
         estimate_line("known from", estimate.from_store ? "the store (whole blocks counted)"
                                                         : "the headers (estimated)");
}

Result<void> tell_estimate(const ReportFile& report, const std::string& text,
                           const std::string& json) {
  if (!report.to_stdout()) PSS_TRY(print_data(text));
  return report.write(json);
}

}  // namespace pss
