#include "stream/jobs/job_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "io/file/hash.h"
#include "stream/jobs/json_text.h"
#include "stream/jobs/shallow_json.h"

namespace pss {
namespace {

using nlohmann::json;

json to_json(const InputRecord& record) {
  return {{"path", json_text_of(record.path)},
          {"size", record.size},
          {"modified_ns", record.modified_ns},
          {"content_hash", record.content_hash}};
}

InputRecord input_from(const json& j) {
  return {name_of_json_text(j.at("path").get<std::string>()), j.at("size").get<std::uint64_t>(),
          j.at("modified_ns").get<std::int64_t>(), j.at("content_hash").get<std::uint64_t>()};
}

json to_json(const FileContent& content) {
  return {{"size", content.size},
          {"modified_ns", content.modified_ns},
          {"hash", to_string(content.hash)}};
}

FileContent content_from(const json& j) {
  return {j.at("size").get<std::uint64_t>(), j.at("modified_ns").get<std::int64_t>(),
          hash128_from(j.at("hash").get<std::string>())};
}

/// What decides the result.
json identity_json(const JobRecord& record) {
  json inputs = json::array();
  for (const InputRecord& input : record.inputs) inputs.push_back(to_json(input));
  return {{"command", record.command},
          {"sorting", json::parse(record.sorting)},
          {"parameters", json::parse(record.parameters)},
          {"inputs", inputs}};
}

/// Of all values of a record, whatever the white space between them.
std::string checksum_of(const json& j) {
  const std::string text = j.dump();
  return fmt::format("{:016x}", hash64(std::as_bytes(std::span(text))));
}

/// Errors: throws json::exception for anything but an object.
std::string object_text(const json& j) { return json(j.get<json::object_t>()).dump(); }

/// Names that lead out of the directory are nobody's passes.
bool are_pass_names(const std::vector<std::string>& names) {
  return std::ranges::all_of(names, is_pass_name);
}

JobRecord record_from(const json& j) {
  JobRecord record;
  record.command = j.at("command").get<std::string>();
  record.output = name_of_json_text(j.at("output").get<std::string>());
  record.sorting = object_text(j.at("sorting"));
  record.parameters = object_text(j.at("parameters"));
  for (const json& input : j.at("inputs")) record.inputs.push_back(input_from(input));
  record.passes = j.at("passes").get<std::vector<std::string>>();
  record.may_grow = j.at("may_grow").get<bool>();
  record.spoiled = name_of_json_text(j.at("spoiled").get<std::string>());
  record.discarding = j.at("discarding").get<bool>();
  record.complete = j.at("complete").get<bool>();
  if (j.contains("result")) record.result = content_from(j.at("result"));
  return record;
}

Error not_ours(const std::string& path, const std::string& what) {
  return {Fault::kBadInput,
          fmt::format("{}: {}, so that pss cannot tell whether this directory is its own; remove "
                      "it by hand, or use another --work-dir",
                      path, what)};
}

/// "--radius was 1, is 2 now", of two objects in JSON.
std::string difference(const std::string& then, const std::string& now) {
  const json before = json::parse(then);
  const json after = json::parse(now);
  for (const auto& [name, value] : after.items())
    if (const json was = before.value(name, json()); was != value)
      return fmt::format("--{} was {}, is {} now", name, was.dump(), value.dump());
  return before.size() == after.size() ? "" : "its parameters are of another version of pss";
}

std::string difference(const std::vector<InputRecord>& then, const std::vector<InputRecord>& now) {
  if (then.size() != now.size())
    return fmt::format("{} input files before, {} now", then.size(), now.size());
  const auto [was, is] = std::ranges::mismatch(then, now);
  if (is == now.end()) return "";
  return was->path == is->path ? fmt::format("input {} has changed", is->path)
                               : fmt::format("input {} before, {} now", was->path, is->path);
}

}  // namespace

std::string to_text(const JobRecord& record) {
  json j = identity_json(record);
  j["program"] = "pss";
  j["version"] = kJobRecordVersion;
  j["output"] = json_text_of(record.output);
  j["passes"] = record.passes;
  j["may_grow"] = record.may_grow;
  j["spoiled"] = json_text_of(record.spoiled);
  j["discarding"] = record.discarding;
  j["complete"] = record.complete;
  if (record.result) j["result"] = to_json(*record.result);
  j["checksum"] = checksum_of(j);
  return j.dump(1) + "\n";
}

Result<JobRecord> job_record_from(const std::string& path, std::span<const std::byte> bytes) {
  try {
    json j = parse_shallow<json>({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    const auto expected = j.at("checksum").get<std::string>();
    j.erase("checksum");
    if (j.at("program") != "pss" || checksum_of(j) != expected)
      return not_ours(path, fmt::format("damaged at offset 0: the {} bytes do not match their "
                                        "checksum",
                                        bytes.size()));
    if (j.at("version") != kJobRecordVersion)
      return Error{Fault::kBadInput,
                   fmt::format("{}: found a record of version {}, expected {}: the job is of "
                               "another version of pss; end it with that one, or use another "
                               "--work-dir",
                               path, j.at("version").dump(), kJobRecordVersion)};
    JobRecord record = record_from(j);
    if (!are_pass_names(record.passes))
      return not_ours(path, "damaged at offset 0: found a pass of a name that none has");
    return record;
  } catch (const json::exception& e) {
    return not_ours(path, fmt::format("damaged at offset 0: found no job record ({})", e.what()));
  }
}

bool is_pass_name(const std::string& name) {
  constexpr const char* kLetters = "abcdefghijklmnopqrstuvwxyz0123456789-";
  return !name.empty() && name.find_first_not_of(kLetters) == std::string::npos &&
         name != "input" && name != "replaced";
}

std::string identity_of(const JobRecord& record) {
  const std::string text = identity_json(record).dump();
  StreamHash hash;
  hash.update(std::as_bytes(std::span(text)));
  return to_string(hash.digest());
}

std::string all_parameters(const JobRecord& record) {
  json all = json::parse(record.parameters);
  all.update(json::parse(record.sorting));
  return all.dump();
}

std::string sorting_difference(const JobRecord& then, const JobRecord& now) {
  if (then.command != now.command)
    return fmt::format("command {} before, {} now", then.command, now.command);
  if (then.output != now.output)
    return fmt::format("output {} before, {} now", then.output, now.output);
  const std::string parameter = difference(then.sorting, now.sorting);
  return parameter.empty() ? difference(then.inputs, now.inputs) : parameter;
}

std::string difference(const JobRecord& then, const JobRecord& now) {
  const std::string sorting = sorting_difference(then, now);
  return sorting.empty() ? difference(then.parameters, now.parameters) : sorting;
}

}  // namespace pss
