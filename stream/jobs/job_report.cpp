#include "stream/jobs/job_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace pss {
namespace {

using nlohmann::ordered_json;

double share(double part, double whole) { return whole > 0 ? part / whole : 0; }

ordered_json stage_json(const StageReport& stage) {
  ordered_json j = {{"name", stage.name},
                    {"seconds", stage.seconds},
                    {"read", stage.transfer.read},
                    {"written", stage.transfer.written}};
  if (stage.schedule) j["schedule"] = schedule_json(*stage.schedule);
  return j;
}

}  // namespace

StageTimer::~StageTimer() {
  report_.seconds = watch_.seconds();
  report_.transfer = transferred_since(before_);
  stages_->push_back(std::move(report_));
}

StageReport JobReport::stage(std::string_view name) const {
  const auto found = std::ranges::find(stages, name, &StageReport::name);
  return found == stages.end() ? StageReport{std::string(name), 0, {}, {}} : *found;
}

ordered_json head_json(const JobReport& report) {
  return {{"command", report.command},
          {"inputs", report.inputs},
          {"output", report.output},
          {"work_dir", report.work_dir},
          {"already_complete", report.already_complete},
          {"resumed", report.resumed}};
}

void add_tail_json(const JobReport& report, ordered_json& json) {
  json["stages"] = ordered_json::array();
  for (const StageReport& stage : report.stages) json["stages"].push_back(stage_json(stage));
  json["bytes"] = {{"sorted_input", report.store_bytes}, {"result", report.result_bytes}};
  json["memory"] = {{"peak", report.peak_memory}, {"limit", report.memory_limit}};
  json["threads"] = report.threads;
  json["notes"] = report.notes;
}

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

std::string report_text(const ordered_json& json) {
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace pss
