#include "stream/jobs/tile.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/file/file.h"
#include "io/inputs.h"
#include "stream/jobs/job_kind.h"
#include "stream/jobs/run_job.h"

namespace pss {
namespace {

class TileKind : public JobKind {
 public:
  explicit TileKind(const TileJob& job) : job_(job) {}

  std::string_view command() const override { return "tile"; }
  nlohmann::json parameters() const override { return nlohmann::json::object(); }
  SortingChoice sorting() const override { return {job_.lattice_step, true}; }
  PassNames passes() const override { return {}; }

  Result<void> check() const override {
    if (!is_store_name(job_.output))
      return Error{Fault::kUsage,
                   fmt::format("--output: found '{}', expected NAME.pss", job_.output)};
    return check_files(job_.inputs);
  }

  Result<std::optional<Pass>> next(PassContext& /*job*/) override { return std::optional<Pass>(); }

 private:
  const TileJob& job_;
};

}  // namespace

Result<JobReport> tile(const TileJob& job, MemoryBudget& budget, Monitor& monitor) {
  TileKind kind(job);
  return run_job(job, kind, budget, monitor);
}

std::string tile_json(const JobReport& report) {
  nlohmann::ordered_json j = head_json(report);
  if (report.already_complete) return report_text(j);
  j.update(nlohmann::ordered_json::parse(to_json(report.ingest)));
  j["tiles"] = report.tiles;
  add_tail_json(report, j);
  return report_text(j);
}

}  // namespace pss
