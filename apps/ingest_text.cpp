#include "apps/ingest_text.h"

#include <fmt/format.h>

#include "apps/progress_view.h"

namespace pss {

std::vector<std::string> ingest_lines(const IngestSummary& summary) {
  std::vector<std::string> lines;
  if (summary.dropped_not_finite > 0)
    lines.push_back(fmt::format("dropped {} points whose position is not finite",
                                grouped(summary.dropped_not_finite)));
  if (summary.dropped_outside > 0)
    lines.push_back(fmt::format("dropped {} points outside the box of --drop-outside",
                                grouped(summary.dropped_outside)));
  if (summary.moved_to_lattice == 0) return lines;
  const std::string beside =
      summary.spacing > 0 ? fmt::format("; their spacing is about {:.3g}", summary.spacing) : "";
  lines.push_back(fmt::format("moved {} points onto the common lattice, by {:.3g} at most{}",
                              grouped(summary.moved_to_lattice), summary.largest_move, beside));
  return lines;
}

}  // namespace pss
