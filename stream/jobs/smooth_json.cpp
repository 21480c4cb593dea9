#include "stream/jobs/smooth_json.h"

#include <nlohmann/json.hpp>

#include "stream/jobs/shallow_json.h"
#include "stream/jobs/smooth_method.h"
#include "stream/widths/widths_json.h"

namespace pss {
namespace {

using nlohmann::ordered_json;

/// apss and rimls have no polynomial of the user's choice.
ordered_json method_json(const Method& method) {
  const bool has_order = !needs_normals(method.op);
  return {{"operator", name_of(method.op)},
          {"weight", name_of(method.weight)},
          {"precision", name_of(method.precision)},
          {"polynomial_order", has_order ? ordered_json(method.degree) : ordered_json()}};
}

/// The method and where its normals come from; null where it looks at none.
ordered_json method_json(const Method& method, NormalsFrom normals) {
  ordered_json j = method_json(method);
  j["normals"] = normals == NormalsFrom::kNowhere ? ordered_json() : ordered_json(name_of(normals));
  return j;
}

ordered_json ingest_json(const IngestSummary& ingest) {
  return ordered_json::parse(to_json(ingest), nullptr, false);
}

ordered_json statuses_json(const ProjectStatistics& statistics) {
  ordered_json statuses;
  for (int s = 0; s < kStatusCount; ++s)
    statuses[status_name(static_cast<Status>(s))] =
        statistics.statuses[static_cast<std::size_t>(s)];
  return statuses;
}

double share(double part, double whole) { return whole > 0 ? part / whole : 0; }

ordered_json schedule_json(const ScheduleSummary& schedule) {
  const double own = static_cast<double>(schedule.own_points);
  return {{"tiles", schedule.tiles},
          {"resumed_tiles", schedule.resumed_tiles},
          {"parts", schedule.parts},
          {"reloaded_parts", schedule.reloaded_parts},
          {"halo_share", share(static_cast<double>(schedule.halo_points), own)},
          {"compute_seconds", schedule.compute_seconds},
          {"wait_seconds", schedule.wait_seconds},
          {"wait_share",
           {{"reading", share(schedule.wait_reading, schedule.seconds)},
            {"memory", share(schedule.wait_memory, schedule.seconds)},
            {"commit", share(schedule.wait_commit, schedule.seconds)}}},
          {"load_seconds", schedule.load_seconds},
          {"encode_seconds", schedule.encode_seconds},
          {"write_seconds", schedule.write_seconds}};
}

ordered_json transfer_json(const Transfer& transfer, std::uint64_t points) {
  const auto count = static_cast<double>(points);
  return {{"read", share(static_cast<double>(transfer.read), count)},
          {"written", share(static_cast<double>(transfer.written), count)}};
}

/// Bytes a point of the output, by stage.
ordered_json transfers_json(const SmoothReport& report) {
  const std::uint64_t points = report.points_out;
  return {{"ingest", transfer_json(report.ingest_transfer, points)},
          {"spacing", transfer_json(report.spacing_transfer, points)},
          {"normals", transfer_json(report.normals_transfer, points)},
          {"smooth", transfer_json(report.smooth_transfer, points)},
          {"write", transfer_json(report.write_transfer, points)}};
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
  return {{"plan", report.plan_seconds},       {"ingest", report.ingest_seconds},
          {"spacing", report.spacing_seconds}, {"normals", report.normals_seconds},
          {"smooth", report.smooth_seconds},   {"write", report.write_seconds},
          {"total", report.total_seconds}};
}

/// Errors: throws json::exception where a value is of another type.
void read_summary(const ordered_json& j, SmoothReport& report) {
  if (!j.is_object()) return;
  if (Result<IngestSummary> ingest =
          ingest_summary_from_json(j.value("ingest", ordered_json()).dump()))
    report.ingest = *ingest;
  report.normals = normals_named(j.value("normals", ""));
  report.widths = widths_from_json(j.value("widths", ordered_json::object()));
  report.notes = j.value("notes", std::vector<std::string>());
  report.store_bytes = j.value("store_bytes", std::uint64_t{0});
}

}  // namespace

std::string result_parameters(const SmoothJob& job, const ChosenWidths& widths,
                              const std::string& identity) {
  ordered_json j = method_json(method_of(job.options));
  j["radius"] = widths.radius;
  j["h"] = widths.h;
  j["knn"] = widths.nearest;
  j["radius_per_distance"] = widths.factor;
  j["cap"] = widths.cap;
  j["job"] = identity;
  return j.dump();
}

std::string identity_in(const std::string& result_parameters) {
  const auto j = parse_shallow<ordered_json>(result_parameters);
  const auto found = j.is_object() ? j.find("job") : j.end();
  return found != j.end() && found->is_string() ? found->get<std::string>() : "";
}

std::string result_summary(const SmoothReport& report) {
  IngestSummary ingest = report.ingest;
  ingest.read_seconds = ingest.merge_seconds = 0;  // times are no part of what a run makes
  return ordered_json{{"ingest", ingest_json(ingest)},
                      {"normals", name_of(report.normals)},
                      {"widths", widths_json(report.widths)},
                      {"notes", report.notes},
                      {"store_bytes", report.store_bytes}}
      .dump();
}

void read_result_summary(const std::string& summary, SmoothReport& report) {
  try {
    read_summary(parse_shallow<ordered_json>(summary), report);
  } catch (const ordered_json::exception&) {
    // Another version's: what it says otherwise stays unknown.
  }
}

std::string to_json(const SmoothReport& report) {
  const ProjectStatistics& s = report.statistics;
  ordered_json j = {{"command", "smooth"},
                    {"inputs", report.inputs},
                    {"output", report.output},
                    {"work_dir", report.work_dir},
                    {"already_complete", report.already_complete},
                    {"resumed", report.resumed}};
  if (report.already_complete) return j.dump(2, ' ', false, ordered_json::error_handler_t::replace);
  j["points"] = points_json(report);
  j["moved_to_lattice"] = {{"points", report.ingest.moved_to_lattice},
                           {"largest", report.ingest.largest_move},
                           {"spacing", report.ingest.spacing}};
  j["method"] = method_json(report.method, report.normals);
  j["widths"] = widths_json(report.widths);
  j["neighbours"] = {{"mean", s.mean_neighbours()}, {"most", s.most_neighbours}};
  j["displacement"] = {{"rms", s.rms_displacement()}, {"largest", s.largest_displacement}};
  j["residual"] = {{"rms", s.rms_residual()}};
  j["rounding_step"] = report.rounding_step;
  j["tiles"] = report.tiles;
  j["schedule"] = schedule_json(report.schedule);
  j["seconds"] = seconds_json(report);
  j["bytes"] = {{"sorted_input", report.store_bytes}, {"result", report.result_bytes}};
  j["bytes_per_point"] = transfers_json(report);
  j["memory"] = {{"peak", report.peak_memory}, {"limit", report.memory_limit}};
  j["threads"] = report.threads;
  j["notes"] = report.notes;
  return j.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

std::string to_json(const SmoothEstimate& estimate) {
  return ordered_json{{"command", "smooth"},
                      {"dry_run", true},
                      {"from_store", estimate.from_store},
                      {"points", estimate.points},
                      {"tiles", estimate.tiles},
                      {"parts", estimate.parts},
                      {"halo_share", estimate.halo_share},
                      {"memory", {{"peak", estimate.peak_memory}}},
                      {"disk_bytes", estimate.disk_bytes},
                      {"seconds", estimate.seconds},
                      {"method", method_json(estimate.method, estimate.normals)},
                      {"widths", widths_json(estimate.widths)}}
      .dump(2);
}

}  // namespace pss
