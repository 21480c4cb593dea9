#include "stream/jobs/finished.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <span>

#include "io/file/hash.h"
#include "stream/jobs/json_text.h"
#include "stream/jobs/shallow_json.h"

namespace pss {
namespace {

using nlohmann::json;

constexpr std::uint64_t kLargestRecord = 64 << 10;
constexpr int kVersion = 1;

std::string hash_text(const std::string& text) {
  StreamHash hash;
  hash.update(std::as_bytes(std::span(text)));
  return to_string(hash.digest());
}

std::string record_path(const std::string& state_folder, const std::string& real_path) {
  return fmt::format("{}/{}.json", state_folder, hash_text(real_path));
}

/// Errors: throws json::exception where it is no record.
std::optional<FinishedOutput> finished_from(json j, const std::string& real_path) {
  const auto checksum = j.at("checksum").get<std::string>();
  j.erase("checksum");
  if (checksum != hash_text(j.dump()) || j.at("version") != kVersion) return std::nullopt;
  if (name_of_json_text(j.at("output").get<std::string>()) != real_path) return std::nullopt;
  return FinishedOutput{j.at("identity").get<std::string>(),
                        {j.at("size").get<std::uint64_t>(), j.at("modified_ns").get<std::int64_t>(),
                         hash128_from(j.at("hash").get<std::string>())}};
}

}  // namespace

Result<void> remember_finished(const std::string& state_folder, const std::string& output,
                               const FinishedOutput& finished) {
  if (state_folder.empty()) return {};
  const std::string real_path = real_path_of(output);
  json j = {{"program", "pss"},
            {"version", kVersion},
            {"output", json_text_of(real_path)},
            {"identity", finished.identity},
            {"size", finished.content.size},
            {"modified_ns", finished.content.modified_ns},
            {"hash", to_string(finished.content.hash)}};
  j["checksum"] = hash_text(j.dump());
  const std::string text = j.dump(1) + "\n";
  PSS_TRY(make_directories(state_folder));
  return replace_file(record_path(state_folder, real_path), std::as_bytes(std::span(text)));
}

std::optional<FinishedOutput> recall_finished(const std::string& state_folder,
                                              const std::string& output) {
  if (state_folder.empty()) return std::nullopt;
  const std::string real_path = real_path_of(output);
  const auto bytes = read_whole(record_path(state_folder, real_path), kLargestRecord);
  if (!bytes) return std::nullopt;
  try {
    return finished_from(
        parse_shallow<json>({reinterpret_cast<const char*>(bytes->data()), bytes->size()}),
        real_path);
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

}  // namespace pss
