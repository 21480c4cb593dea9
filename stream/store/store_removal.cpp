// What of a directory may be removed as a store: only what a writer of stores made.

#include <fmt/format.h>

#include "stream/store/log.h"
#include "stream/store/manifest.h"
#include "stream/store/store_writer.h"

namespace pss {
namespace {

/// The names that a store's directory may hold, finished or not.
bool is_store_file(const std::string& name) {
  const std::string store;
  return store + "/" + name == manifest_path(store) ||
         store + "/" + name == open_manifest_path(store) ||
         store + "/" + name == replacement_of(open_manifest_path(store)) ||
         store + "/" + name == inputs_path(store) ||
         store + "/" + name == replacement_of(inputs_path(store)) || is_numbered(name, "segment-");
}

/// Whether something in a store's directory is a part of it: a file by its name, and, where the
/// manifest is whole, none of a segment that it does not speak of.
bool is_part(const std::string& store, const std::string& name, const Manifest& manifest) {
  const std::string path = store + "/" + name;
  if (!is_store_file(name) || (is_directory(path) && !is_link(path))) return false;
  if (!manifest.complete || !is_numbered(name, "segment-")) return true;
  return manifest.segments() > 0 && path <= segment_path(store, manifest.segments() - 1);
}

/// A store's manifest as far as it can be read.
Manifest readable_manifest(const std::string& store) {
  Manifest manifest;
  const std::string path = manifest_path(store);
  static_cast<void>(read_log(path, Tail::kWhole,
                             [&](const LogRecord& record) { return manifest.add(path, record); }));
  return manifest;
}

}  // namespace

Result<void> check_removable(const std::string& path) {
  if (!exists(path)) return {};
  if (is_link(path))
    return Error{Fault::kFailed, fmt::format("{}: is a link, not a store; name the store that it "
                                             "leads to, or choose another name",
                                             path)};
  PSS_ASSIGN(const std::vector<std::string> names, list_directory(path));
  const Manifest manifest = readable_manifest(path);
  for (const std::string& name : names)
    if (!is_part(path, name, manifest))
      return Error{Fault::kFailed,
                   fmt::format("{}: holds {}, which is no part of a store; choose another name",
                               path, name)};
  // Names prove nothing. Without a manifest, only what a killed writer leaves before it has one.
  const bool begun =
      names.empty() || names == std::vector<std::string>{replacement_of("manifest.log")};
  if (begun || has_manifest(path)) return {};
  return Error{Fault::kFailed, fmt::format("{}: holds {}, but no manifest of a store; choose "
                                           "another name",
                                           path, names.front())};
}

Result<void> remove_store(const std::string& path) {
  PSS_TRY(check_removable(path));
  return remove_store_files(path);
}

Result<void> remove_store_files(const std::string& path) {
  return remove_own_directory(path, is_store_file);
}

}  // namespace pss
