// IngestSummary of stream/sort/ingest.h as JSON.

#include <nlohmann/json.hpp>

#include "stream/sort/ingest.h"

namespace pss {

std::string to_json(const IngestSummary& summary) {
  const nlohmann::ordered_json json = {
      {"points_read", summary.points_read},
      {"points_stored", summary.points_stored},
      {"dropped_not_finite", summary.dropped_not_finite},
      {"dropped_outside", summary.dropped_outside},
      {"moved_to_lattice", summary.moved_to_lattice},
      {"largest_move", summary.largest_move},
      {"spacing", summary.spacing},
      {"read_seconds", summary.read_seconds},
      {"merge_seconds", summary.merge_seconds},
  };
  return json.dump();
}

Result<IngestSummary> ingest_summary_from_json(const std::string& text) {
  const auto json = nlohmann::json::parse(text, nullptr, false);
  const auto number = [&](const char* key, auto fallback) {
    const auto found = json.is_object() ? json.find(key) : json.end();
    const bool good = json.is_object() && found != json.end() && found->is_number();
    return good ? found->template get<decltype(fallback)>() : fallback;
  };
  if (!json.is_object())
    return Error{Fault::kBadInput, "the summary of the store is no JSON object; make it anew"};
  IngestSummary summary;
  summary.points_read = number("points_read", std::uint64_t{0});
  summary.points_stored = number("points_stored", std::uint64_t{0});
  summary.dropped_not_finite = number("dropped_not_finite", std::uint64_t{0});
  summary.dropped_outside = number("dropped_outside", std::uint64_t{0});
  summary.moved_to_lattice = number("moved_to_lattice", std::uint64_t{0});
  summary.largest_move = number("largest_move", 0.0);
  summary.spacing = number("spacing", 0.0);
  summary.read_seconds = number("read_seconds", 0.0);
  summary.merge_seconds = number("merge_seconds", 0.0);
  return summary;
}

}  // namespace pss
