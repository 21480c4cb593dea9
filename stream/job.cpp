#include "stream/job.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/fingerprint.h"
#include "io/hash.h"
#include "stream/shallow_json.h"
#include "stream/store_writer.h"

namespace pss {
namespace {

using nlohmann::json;

constexpr std::uint64_t kLargestRecord = 64u << 20;
/// Of an input, as a name, a fingerprint, what is kept of its header, and JSON; and of its path, so
/// many copies. Measured: 2.4 KB for a path of 110 bytes.
constexpr std::uint64_t kInputBytes = 1600;
constexpr std::uint64_t kPathCopies = 8;

std::string record_path(const std::string& work_dir) { return work_dir + "/job.json"; }

json to_json(const InputRecord& record) {
  return {{"path", record.path},
          {"size", record.size},
          {"modified_ns", record.modified_ns},
          {"content_hash", record.content_hash}};
}

InputRecord input_from(const json& j) {
  return {j.at("path").get<std::string>(), j.at("size").get<std::uint64_t>(),
          j.at("modified_ns").get<std::int64_t>(), j.at("content_hash").get<std::uint64_t>()};
}

std::string dumped(const json& j) {
  return j.dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

/// Of all values of a record, whatever the white space between them.
std::string checksum_of(const json& j) {
  const std::string text = dumped(j);
  return fmt::format("{:016x}", hash64(std::as_bytes(std::span(text))));
}

std::string to_text(const JobRecord& record) {
  json inputs = json::array();
  for (const InputRecord& input : record.inputs) inputs.push_back(to_json(input));
  json j = {{"format", 1},
            {"command", record.command},
            {"output", record.output},
            {"parameters", json::parse(record.parameters)},
            {"inputs", inputs},
            {"complete", record.complete}};
  if (record.result) j["result"] = to_json(*record.result);
  j["checksum"] = checksum_of(j);
  return dumped(j);
}

Error damaged(const std::string& path, const std::string& what) {
  return {Fault::kBadInput, fmt::format("{}: damaged at offset 0: {}; use --restart", path, what)};
}

JobRecord record_from(const json& j) {
  JobRecord record;
  record.command = j.at("command").get<std::string>();
  record.output = j.at("output").get<std::string>();
  record.parameters = j.at("parameters").dump();
  for (const json& input : j.at("inputs")) record.inputs.push_back(input_from(input));
  record.complete = j.at("complete").get<bool>();
  if (j.contains("result")) record.result = input_from(j.at("result"));
  return record;
}

Error other_job(const std::string& work_dir, const std::string& difference) {
  return {Fault::kFailed,
          fmt::format("{}: holds another job: {}; use --restart to discard it, or another "
                      "--work-dir",
                      work_dir, difference)};
}

/// The file by which an output is known again: itself, or a store's manifest.
std::string witness_of(const std::string& output) {
  return is_store_name(output) ? manifest_path(output) : output;
}

/// Refuses a directory without a job's record that holds anything else.
Result<void> check_work_directory(const std::string& path) {
  if (exists(record_path(path))) return {};
  if (!is_directory(path)) return {};
  PSS_ASSIGN(const std::vector<std::string> names, list_directory(path));
  for (const std::string& name : names)
    if (name != "lock" && name != "job.json.part")
      return Error{Fault::kFailed,
                   fmt::format("{}: found {}, expected an empty or new work directory; use another "
                               "--work-dir",
                               path, name)};
  return {};
}

}  // namespace

Result<void> check_same_job(const JobRecord& then, const JobRecord& now,
                            const std::string& work_dir) {
  if (then.command != now.command)
    return other_job(work_dir, fmt::format("command {} before, {} now", then.command, now.command));
  if (then.output != now.output)
    return other_job(work_dir, fmt::format("output {} before, {} now", then.output, now.output));
  const json before = json::parse(then.parameters);
  const json after = json::parse(now.parameters);
  for (const auto& [name, value] : after.items())
    if (const json was = before.value(name, json()); was != value)
      return other_job(work_dir,
                       fmt::format("--{} was {}, is {} now", name, was.dump(), value.dump()));
  if (then.inputs.size() != now.inputs.size())
    return other_job(work_dir, fmt::format("{} input files before, {} now", then.inputs.size(),
                                           now.inputs.size()));
  for (std::size_t i = 0; i < now.inputs.size(); ++i)
    if (then.inputs[i] != now.inputs[i])
      return other_job(work_dir, then.inputs[i].path == now.inputs[i].path
                                     ? fmt::format("input {} has changed", now.inputs[i].path)
                                     : fmt::format("input {} before, {} now", then.inputs[i].path,
                                                   now.inputs[i].path));
  return {};
}

bool wrote(const JobRecord& record, const std::string& path) {
  if (!record.result) return false;
  const Result<InputRecord> now = fingerprint(path);
  return now && now->size == record.result->size &&
         now->modified_ns == record.result->modified_ns &&
         now->content_hash == record.result->content_hash;
}

Result<WorkDirectory> WorkDirectory::open(const std::string& path) {
  PSS_TRY(make_directories(path));
  PSS_ASSIGN(FileLock lock, FileLock::take(path + "/lock"));
  return WorkDirectory(path, std::move(lock));
}

Result<std::optional<JobRecord>> read_job_record(const std::string& work_dir) {
  const std::string path = record_path(work_dir);
  if (!exists(path)) return std::optional<JobRecord>();
  PSS_ASSIGN(const std::vector<std::byte> bytes, read_whole(path, kLargestRecord));
  try {
    json j = parse_shallow<json>({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const auto expected = j.at("checksum").get<std::string>();
    j.erase("checksum");
    if (checksum_of(j) != expected)
      return damaged(path, fmt::format("the {} bytes do not match their checksum", bytes.size()));
    return std::optional(record_from(j));
  } catch (const json::exception& e) {
    return damaged(path, fmt::format("found no job record ({})", e.what()));
  }
}

Result<std::optional<JobRecord>> WorkDirectory::read_record() const {
  return read_job_record(path_);
}

Result<void> WorkDirectory::write_record(const JobRecord& record) const {
  const std::string text = to_text(record);
  return replace_file(record_path(path_), std::as_bytes(std::span(text)));
}

Result<void> WorkDirectory::remove_sources() const {
  for (const char* name : {"/runs", "/input.pss", "/normals.pss"})
    PSS_TRY(remove_all(path_ + name));
  return {};
}

Result<void> WorkDirectory::remove_data() const {
  PSS_TRY(remove_sources());
  return remove_all(result_store());
}

Result<void> WorkDirectory::clear() const {
  PSS_TRY(remove_data());
  // Order: the data is gone before the record that tells whose it was. Otherwise a power cut could
  // leave data that belongs to no job.
  PSS_TRY(sync_directory(path_));
  PSS_TRY(remove_all(record_path(path_)));
  return sync_directory(path_);
}

std::optional<std::string> job_holder(const std::string& work_dir) {
  return lock_holder(work_dir + "/lock");
}

Result<void> check_places(const JobPlaces& places) {
  for (const std::string& input : places.inputs)
    if (lies_in(input, places.work_dir))
      return Error{Fault::kUsage, fmt::format("{}: lies in the work directory {}; use another "
                                              "--work-dir",
                                              input, places.work_dir)};
  if (lies_in(places.output, places.work_dir))
    return Error{Fault::kUsage,
                 fmt::format("{}: the output lies in the work directory {}; use another --work-dir",
                             places.output, places.work_dir)};
  if (is_store_name(places.output) && !same_disk(places.work_dir, directory_of(places.output)))
    return Error{
        Fault::kUsage,
        fmt::format("--work-dir {}: lies on another disk than {}, which a store is renamed "
                    "to; use one on the same disk",
                    places.work_dir, places.output)};
  return check_work_directory(places.work_dir);
}

Result<Reservation> reserve_names(const std::vector<std::string>& inputs, MemoryBudget& budget) {
  std::uint64_t bytes = 0;
  for (const std::string& input : inputs) bytes += kInputBytes + kPathCopies * input.size();
  if (auto reservation = budget.reserve(bytes)) return *std::move(reservation);
  return Error{Fault::kMemoryLimit,
               fmt::format("the names of {} inputs take {} MiB, {} are left of the memory limit; "
                           "use --memory-limit {}M or more",
                           inputs.size(), (bytes >> 20) + 1, budget.available() >> 20,
                           ((budget.limit() + bytes - budget.available()) >> 20) + 1)};
}

Result<Entry> enter_job(const JobPlaces& places, const WorkDirectory& work, JobRecord& record) {
  auto found = work.read_record();
  // A record that is damaged is in nobody's way who starts over.
  if (!found && !(places.restart && found.error().fault == Fault::kBadInput)) return found.error();
  std::optional<JobRecord> before = found ? *std::move(found) : std::nullopt;
  const bool known = before && wrote(*before, witness_of(places.output));
  if (known && !places.restart && check_same_job(*before, record, work.path())) {
    PSS_TRY(leave_job(places, work, record));
    return Entry::kComplete;
  }
  if (exists(places.output) && !places.overwrite)
    return Error{Fault::kFailed,
                 fmt::format("{}: exists; use --overwrite to replace it", places.output)};
  // A complete job here has lost its output, or is to be done again.
  if (places.restart || (before && before->complete)) {
    PSS_TRY(work.clear());
    before.reset();
  }
  if (before) PSS_TRY(check_same_job(*before, record, work.path()));
  PSS_TRY(work.write_record(record));
  return before ? Entry::kResumed : Entry::kNew;
}

Result<void> record_result(const WorkDirectory& work, JobRecord& record, const std::string& file) {
  PSS_ASSIGN(record.result, fingerprint(file));
  return work.write_record(record);
}

Result<void> hand_over_store(const std::string& store, const JobPlaces& places,
                             const WorkDirectory& work, JobRecord& record) {
  PSS_TRY(record_result(work, record, manifest_path(store)));
  if (places.overwrite) PSS_TRY(remove_store(places.output));
  return rename_file(store, places.output);
}

Result<void> leave_job(const JobPlaces& places, const WorkDirectory& work, JobRecord& record) {
  record.complete = true;
  PSS_TRY(record_result(work, record, witness_of(places.output)));
  return places.keep_work ? Result<void>() : work.remove_data();
}

}  // namespace pss
