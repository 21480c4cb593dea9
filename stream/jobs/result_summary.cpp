// result_summary() of stream/jobs/run_job.h: what the store of a result keeps of its job.

#include <nlohmann/json.hpp>

#include "stream/jobs/run_job.h"
#include "stream/jobs/shallow_json.h"

namespace pss {
namespace {

using nlohmann::ordered_json;

/// Errors: throws json::exception where a value is of another type.
void read_summary(const ordered_json& j, JobReport& report, JobKind& kind) {
  if (!j.is_object()) return;
  if (Result<IngestSummary> ingest =
          ingest_summary_from_json(j.value("ingest", ordered_json()).dump()))
    report.ingest = *ingest;
  kind.recall(j);
  report.notes = j.value("notes", std::vector<std::string>());
  report.store_bytes = j.value("store_bytes", std::uint64_t{0});
}

}  // namespace

std::string result_summary(const JobReport& report, const JobKind& kind) {
  IngestSummary ingest = report.ingest;
  ingest.read_seconds = ingest.merge_seconds = 0;  // times are no part of what a run makes
  ordered_json j{{"ingest", ordered_json::parse(to_json(ingest), nullptr, false)}};
  kind.remember(j);
  j["notes"] = report.notes;
  j["store_bytes"] = report.store_bytes;
  return j.dump();
}

void read_result_summary(const std::string& summary, JobReport& report, JobKind& kind) {
  try {
    read_summary(parse_shallow<ordered_json>(summary), report, kind);
  } catch (const ordered_json::exception&) {
    // Another version's: what it says otherwise stays unknown.
  }
}

}  // namespace pss
