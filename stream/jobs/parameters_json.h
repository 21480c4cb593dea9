#pragma once
// Parameters that jobs have in common, as their records and identities have them.

#include <nlohmann/json.hpp>
#include <optional>

#include "stream/jobs/job_request.h"

namespace pss {

/// Null where it was not given.
template <class T>
nlohmann::json optional_json(const std::optional<T>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

/// Adds the scale and the offset of the output, by the names of the flags.
inline void add_grid_json(const JobRequest& request, nlohmann::json& parameters) {
  parameters["scale"] = request.scale_auto ? nlohmann::json("auto") : optional_json(request.scale);
  parameters["offset"] = optional_json(request.offset);
}

}  // namespace pss
