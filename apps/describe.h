#pragma once
// What is in a file or a store, as JSON and as a table for people: `pss info`.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "io/points/reader.h"
#include "stream/jobs/job_state.h"
#include "stream/store/store.h"

namespace pss {

/// What the header says; with `scan`, what all the points say too (counted, measured bounds).
///
/// Errors: with `scan`, those of reading.
Result<nlohmann::ordered_json> describe_file(Reader& reader, bool scan);

/// What the manifest says and, of a complete store, its table of inputs, without their heads.
///
/// Errors: kBadInput where the table is damaged.
Result<nlohmann::ordered_json> describe_store(const Store& store);

/// How far a job is.
nlohmann::ordered_json describe_job(const std::string& work_dir, const JobState& state);

/// The same facts, one a line, attributes as rows of a table.
std::string as_table(const nlohmann::ordered_json& facts);

}  // namespace pss
