#pragma once
// What a work directory says of its job: the record job.json.

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "io/file/content_hash.h"
#include "io/file/fingerprint.h"

namespace pss {

struct JobRecord {
  std::string command;
  std::string output;
  std::string sorting;  ///< JSON object: of the parameters, those that the sorted input depends on
  std::string parameters;  ///< JSON object: all others that the result depends on
  std::vector<InputRecord> inputs;
  /// Names of the passes over the sorted input, in their order. Each is here before its store is
  /// made, so that whatever stays after a kill is known to be the job's.
  std::vector<std::string> passes;
  bool may_grow = false;    ///< the last of these may not be the job's last pass
  std::string spoiled;      ///< why what is kept is worthless: an input changed while it was read
  bool discarding = false;  ///< what the job kept is being removed
  bool complete = false;
  std::optional<FileContent> result;  ///< OUTPUT, or its store's manifest, once written
};

/// Of the record's bytes. This program reads no other.
inline constexpr int kJobRecordVersion = 2;

std::string to_text(const JobRecord& record);
/// Errors: kBadInput, naming `path`, where the bytes are no whole record of pss, or of another
///         version.
Result<JobRecord> job_record_from(const std::string& path, std::span<const std::byte> bytes);

/// Whether a pass may have this name: a to z, 0 to 9 and '-', and no other store of a job has it.
bool is_pass_name(const std::string& name);

/// What the result depends on: equal for the same command with equal inputs and parameters,
/// whatever words this version of pss has for them.
std::string identity_of(const JobRecord& record);

/// `sorting` and `parameters` as one JSON object.
std::string all_parameters(const JobRecord& record);

/// The first thing in which `now` is another job than `then`, in words; empty where it is the same.
std::string difference(const JobRecord& then, const JobRecord& now);
/// The same of the sorted input alone.
std::string sorting_difference(const JobRecord& then, const JobRecord& now);

}  // namespace pss
