#include "io/inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/file/disk.h"
#include "io/file/file.h"
#include "io/formats/table.h"

namespace pss {
namespace {

using Paths = std::vector<std::string>;

constexpr std::uint64_t kLargestList = std::uint64_t{64} << 20;

Error failed(const std::string& path, std::string_view what) {
  return {Fault::kFailed, fmt::format("{}: {}", path, what)};
}

/// What the arguments mean so far.
struct Expansion {
  const std::string& output;
  Paths paths;

  /// Adds what was found rather than named: a result among its own inputs is no input.
  void add_found(const std::string& path) {
    if (!same_file(path, output)) paths.push_back(path);
  }
};

bool is_regular_file(const std::string& path) {
  disk::Status status;
  return disk::status(path, disk::Links::kFollow, status) == 0 && status.kind == disk::Kind::kFile;
}

Result<void> add_directory(const std::string& path, Expansion& out) {
  PSS_ASSIGN(const std::vector<std::string> names, list_directory(path));
  Paths found;
  for (const std::string& name : names) {
    const std::string file = path + (path.ends_with('/') ? "" : "/") + name;
    if (is_regular_file(file) && format_by_extension(file)) found.push_back(file);
  }
  if (found.empty()) return failed(path, "found no file to read in this directory");
  for (const std::string& name : found) out.add_found(name);
  return {};
}

Result<void> add_matches(const std::string& pattern, Expansion& out) {
  Paths found;
  const disk::Outcome outcome = disk::match(pattern, found);
  if (outcome == -ENOENT) return failed(pattern, "matches no file");
  if (outcome < 0) return failed(pattern, "cannot be matched: a directory cannot be read");
  for (const std::string& path : found)
    if (!is_directory(path) || is_store_name(path)) out.add_found(path);
  return {};
}

Result<void> add_path(const std::string& path, Expansion& out) {
  disk::Status status;
  const disk::Outcome outcome = disk::status(path, disk::Links::kFollow, status);
  if (outcome == 0 && status.kind == disk::Kind::kDirectory && !is_store_name(path))
    return add_directory(path, out);
  if (outcome == 0) {
    out.paths.push_back(path);
    return {};
  }
  if (path.find_first_of("*?[") != std::string::npos) return add_matches(path, out);
  if (outcome != -ENOENT && outcome != -ENOTDIR)
    return failed(path, std::generic_category().message(static_cast<int>(-outcome)));
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

/// Refuses a file that is there twice.
Result<void> check_distinct(const Paths& paths) {
  std::map<std::pair<std::uint64_t, std::uint64_t>, const std::string*> known;
  for (const std::string& path : paths) {
    disk::Status status;
    if (disk::status(path, disk::Links::kFollow, status) < 0) continue;  // opening it will say so
    const auto [other, is_new] = known.try_emplace({status.device, status.inode}, &path);
    if (!is_new)
      return Error{Fault::kUsage,
                   fmt::format("{} and {}: are the same file, which would give every point twice; "
                               "name it once",
                               *other->second, path)};
  }
  return {};
}

}  // namespace

Result<std::vector<std::string>> expand_inputs(std::span<const std::string> arguments,
                                               const std::string& output) {
  PSS_TRY(check_lists(arguments, output));
  Expansion expansion{output, {}};
  for (const std::string& argument : arguments)
    PSS_TRY(argument.starts_with('@') ? add_list(argument.substr(1), expansion)
                                      : add_path(argument, expansion));
  if (expansion.paths.empty()) return Error{Fault::kFailed, "no input: the list of files is empty"};
  PSS_TRY(check_distinct(expansion.paths));
  return std::move(expansion.paths);
}

Result<void> check_lists(std::span<const std::string> arguments, const std::string& path) {
  for (const std::string& argument : arguments)
    if (argument.starts_with('@') && same_file(argument.substr(1), path))
      return Error{Fault::kUsage,
                   fmt::format("{}: is the list of inputs, {}; an input is never replaced, choose "
                               "another name",
                               path, argument)};
  return {};
}

Result<void> check_output(std::span<const std::string> inputs, const std::string& output) {
  for (const std::string& input : inputs) {
    if (same_file(input, output))
      return Error{Fault::kUsage,
                   fmt::format("{}: is an input, {}; an input is never replaced, choose another "
                               "output",
                               output, input)};
    if (is_store_name(input) && lies_in(output, input))
      return Error{Fault::kUsage,
                   fmt::format("{}: lies in the store {}; choose another output", output, input)};
  }
  if (is_directory(output) && !is_store_name(output))
    return failed(output, "is a directory; name a file in it");
  const std::string folder = directory_of(output);
  if (is_directory(folder)) return {};
  return failed(output, "its folder is missing; make it, or choose another output");
}

Result<void> check_files(std::span<const std::string> inputs) {
  for (const std::string& input : inputs)
    if (is_store_name(input) && is_directory(input))
      return Error{Fault::kUsage,
                   fmt::format("{}: is a store, expected files; write it as one with "
                               "pss export first",
                               input)};
  return {};
}

}  // namespace pss
