#include "io/inputs.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "io/file.h"
#include "io/writer.h"

namespace pss {
namespace {

using Paths = std::vector<std::string>;

constexpr std::uint64_t kLargestList = std::uint64_t{64} << 20;

Error failed(const std::string& path, const char* what) {
  return {Fault::kFailed, fmt::format("{}: {}", path, what)};
}

/// What the arguments mean so far.
struct Expansion {
  const std::string& output;
  Paths paths;

  /// Adds what was found rather than named: a result among its own inputs is no input.
  void add_found(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::equivalent(path, output, ignored)) paths.push_back(path);
  }
};

Result<void> add_directory(const std::string& path, Expansion& out) {
  Paths found;
  std::error_code code;
  std::filesystem::directory_iterator entry(path, code);
  for (; !code && entry != std::filesystem::directory_iterator(); entry.increment(code)) {
    const std::string name = entry->path().string();
    std::error_code ignored;
    if (entry->is_regular_file(ignored) && format_for(name)) found.push_back(name);
  }
  if (code)
    return Error{Fault::kFailed,
                 fmt::format("{}: cannot read the directory: {}", path, code.message())};
  if (found.empty()) return failed(path, "found no file to read in this directory");
  std::ranges::sort(found);
  for (const std::string& name : found) out.add_found(name);
  return {};
}

/// Returns memory of glob(3) at the end of its life.
struct GlobMatches {
  glob_t matches{};
  ~GlobMatches() { globfree(&matches); }
};

Result<void> add_matches(const std::string& pattern, Expansion& out) {
  GlobMatches found;
  const int outcome = ::glob(pattern.c_str(), GLOB_ERR, nullptr, &found.matches);
  if (outcome == GLOB_NOMATCH) return failed(pattern, "matches no file");
  if (outcome != 0) return failed(pattern, "cannot be matched: a directory cannot be read");
  for (std::size_t i = 0; i < found.matches.gl_pathc; ++i) {
    const std::string path = found.matches.gl_pathv[i];
    std::error_code ignored;
    if (!std::filesystem::is_directory(path, ignored) || is_store_name(path)) out.add_found(path);
  }
  return {};
}

Result<void> add_path(const std::string& path, Expansion& out) {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  if (std::filesystem::is_directory(status) && !is_store_name(path))
    return add_directory(path, out);
  if (std::filesystem::exists(status)) {
    out.paths.push_back(path);
    return {};
  }
  if (path.find_first_of("*?[") != std::string::npos) return add_matches(path, out);
  if (code && code != std::errc::no_such_file_or_directory)
    return Error{Fault::kFailed, fmt::format("{}: {}", path, code.message())};
  return failed(path, "no such file or directory");
}

Result<void> add_list(const std::string& path, Expansion& out) {
  PSS_ASSIGN(const std::vector<std::byte> bytes, read_whole(path, kLargestList));
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty()) continue;
    if (line.starts_with('@')) return failed(path, "found a list in a list, expected files");
    PSS_TRY(add_path(std::string(line), out));
  }
  return {};
}

}  // namespace

Result<std::vector<std::string>> expand_inputs(std::span<const std::string> arguments,
                                               const std::string& output) {
  Expansion expansion{output, {}};
  for (const std::string& argument : arguments)
    PSS_TRY(argument.starts_with('@') ? add_list(argument.substr(1), expansion)
                                      : add_path(argument, expansion));
  if (expansion.paths.empty()) return Error{Fault::kFailed, "no input: the list of files is empty"};
  return std::move(expansion.paths);
}

Result<void> check_output(std::span<const std::string> inputs, const std::string& output) {
  std::error_code ignored;
  for (const std::string& input : inputs)
    if (std::filesystem::equivalent(input, output, ignored))
      return Error{Fault::kUsage,
                   fmt::format("{}: is an input, {}; an input is never replaced, choose another "
                               "output",
                               output, input)};
  const std::string folder = directory_of(output);
  if (std::filesystem::is_directory(folder, ignored)) return {};
  return failed(output, "its folder is missing; make it, or choose another output");
}

}  // namespace pss
