#include "apps/report_file.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "apps/standard_streams.h"
#include "io/file/file.h"
#include "io/file/output_file.h"
#include "io/inputs.h"
#include "stream/store/manifest.h"

namespace pss {
namespace {

using nlohmann::json;

constexpr std::uint64_t kLargestReport = 64u << 20;

std::string text_of(const json& j, const char* key) {
  const auto found = j.is_object() ? j.find(key) : j.end();
  return found != j.end() && found->is_string() ? found->get<std::string>() : "";
}

/// A name as reports have it, which are UTF-8.
std::string as_reported(const std::string& name) {
  return json::parse(json(name).dump(-1, ' ', false, json::error_handler_t::replace));
}

/// Whether the file is what this very command reported before.
bool is_same_report(const std::string& path, const ReportRules& rules) {
  const auto bytes = read_whole(path, kLargestReport);
  if (!bytes) return false;
  const std::string text(reinterpret_cast<const char*>(bytes->data()), bytes->size());
  const json found = json::parse(text, nullptr, false);
  return text_of(found, "command") == rules.command &&
         text_of(found, "output") == as_reported(rules.output);
}

Error misplaced(const std::string& path, const std::string& what) {
  return {Fault::kUsage, fmt::format("--report {}: {}; choose another name", path, what)};
}

Result<void> check_place(const std::string& path, const ReportRules& rules) {
  PSS_TRY(check_lists(rules.arguments, path));
  if (real_path_of(path) == real_path_of(rules.output)) return misplaced(path, "is the output");
  if (is_store_name(rules.output) && lies_in(path, rules.output))
    return misplaced(path, fmt::format("lies in the output {}", rules.output));
  if (has_manifest(directory_of(real_path_of(path)))) return misplaced(path, "lies in a store");
  if (!rules.work_dir.empty() && lies_in(path, rules.work_dir))
    return misplaced(path, fmt::format("lies in the work directory {}", rules.work_dir));
  return check_output(rules.inputs, path);
}

}  // namespace

Result<ReportFile> ReportFile::claim(const std::string& name, const ReportRules& rules) {
  ReportFile report(name);
  if (name.empty() || report.to_stdout()) return report;
  PSS_TRY(check_place(name, rules));
  report.replaces_ = rules.overwrite || is_same_report(name, rules);
  PSS_TRY(check_replaceable(name, report.replaces_));
  PSS_ASSIGN(OutputLock lock, OutputLock::take(name));
  report.lock_.emplace(std::move(lock));
  return report;
}

Result<ReportFile> ReportFile::claim(const std::string& name, const std::string& command,
                                     const JobRequest& job,
                                     std::span<const std::string> arguments) {
  return claim(name,
               {command, job.inputs, job.output, job.work_directory(), job.overwrite, arguments});
}

Result<void> ReportFile::write(const std::string& json) const {
  if (name_.empty()) return {};
  if (to_stdout()) return print_data(json + "\n");
  PSS_ASSIGN(OutputFile file, OutputFile::create(name_, {replaces_, &*lock_, {}}));
  PSS_TRY(file.append(json + "\n"));
  return file.finish();
}

}  // namespace pss
