// to_json() of stream/jobs/smooth.h: what a smoothing job did, or would take.

#include <array>
#include <nlohmann/json.hpp>
#include <string>

#include "stream/jobs/smooth.h"
#include "stream/jobs/smooth_method.h"
#include "stream/widths/widths_json.h"

namespace pss {
namespace {

using nlohmann::ordered_json;

/// A stage's name, and its key in the objects that have all stages, whether they ran or not.
struct StageKey {
  const char* name;
  const char* key;
};
constexpr std::array kStages{StageKey{"plan", "plan"},       StageKey{"sort", "ingest"},
                             StageKey{"spacing", "spacing"}, StageKey{"normals", "normals"},
                             StageKey{"smooth", "smooth"},   StageKey{"write", "write"}};

/// The method and where its normals come from; null where it looks at none.
ordered_json choice_json(const SmoothChoices& choices) {
  const bool looks = choices.normals != NormalsFrom::kNowhere;
  ordered_json j = method_json(choices.method);
  j["normals"] = looks ? ordered_json(name_of(choices.normals)) : ordered_json();
  return j;
}

ordered_json statuses_json(const ProjectStatistics& statistics) {
  ordered_json statuses;
  for (int s = 0; s < kStatusCount; ++s)
    statuses[status_name(static_cast<Status>(s))] =
        statistics.statuses[static_cast<std::size_t>(s)];
  return statuses;
}

/// Points by what became of them; in = out + dropped.
ordered_json points_json(const SmoothReport& report) {
  return {{"in", report.points_in},
          {"out", report.points_out},
          {"dropped",
           {{"not_finite", report.ingest.dropped_not_finite},
            {"outside", report.ingest.dropped_outside}}},
          {"status", statuses_json(report.statistics)},
          {"second_sheet", report.statistics.second_sheet},
          {"redone_in_double", report.statistics.redone}};
}

ordered_json seconds_json(const SmoothReport& report) {
  ordered_json seconds;
  for (const StageKey& stage : kStages) seconds[stage.key] = report.stage(stage.name).seconds;
  seconds["total"] = report.total_seconds;
  return seconds;
}

/// Bytes a point of the output, by stage.
ordered_json transfers_json(const SmoothReport& report) {
  ordered_json transfers;
  for (const StageKey& stage : kStages)
    if (stage.name != std::string("plan"))
      transfers[stage.key] = transfer_json(report.stage(stage.name).transfer, report.points_out);
  return transfers;
}

}  // namespace

std::string to_json(const SmoothReport& report) {
  ordered_json j = head_json(report);
  if (report.already_complete) return report_text(j);
  const ProjectStatistics& s = report.statistics;
  j["points"] = points_json(report);
  j["moved_to_lattice"] = {{"points", report.ingest.moved_to_lattice},
                           {"largest", report.ingest.largest_move},
                           {"spacing", report.ingest.spacing}};
  j["method"] = choice_json(report.choices);
  j["widths"] = widths_json(report.choices.widths);
  j["neighbours"] = {{"mean", s.mean_neighbours()}, {"most", s.most_neighbours}};
  j["displacement"] = {{"rms", s.rms_displacement()}, {"largest", s.largest_displacement}};
  j["residual"] = {{"rms", s.rms_residual()}};
  j["rounding_step"] = report.rounding_step;
  j["tiles"] = report.tiles;
  j["schedule"] = schedule_json(report.stage("smooth").schedule.value_or(ScheduleSummary()));
  j["seconds"] = seconds_json(report);
  j["bytes_per_point"] = transfers_json(report);
  add_tail_json(report, j);
  return report_text(j);
}

std::string to_json(const SmoothEstimate& estimate) {
  ordered_json j = estimate_json("smooth", estimate);
  j["method"] = choice_json(estimate.choices);
  j["widths"] = widths_json(estimate.choices.widths);
  return j.dump(2);
}

}  // namespace pss
