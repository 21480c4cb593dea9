#include "io/open.h"

#include <fmt/format.h>

#include <array>
#include <string_view>
#include <utility>

#include "io/file/file.h"
#include "io/formats/table.h"

namespace pss {
namespace {

constexpr std::size_t kSniffed = 4096;

struct Signature {
  std::string_view start;
  const char* name;
};

/// What point clouds come in, or is taken for them, and no format of the table reads.
constexpr std::array kUnsupported{Signature{"ASTM-E57", "E57"},
                                  Signature{"# .PCD", "PCD"},
                                  Signature{"# PCD", "PCD"},
                                  Signature{"VERSION 0.7", "PCD"},
                                  Signature{"VERSION .7", "PCD"},
                                  Signature{"OFF\n", "OFF"},
                                  Signature{"OFF\r", "OFF"},
                                  Signature{"OFF ", "OFF"},
                                  Signature{"COFF", "OFF"},
                                  Signature{"NOFF", "OFF"},
                                  Signature{"solid ", "STL"},
                                  Signature{"glTF", "glTF"},
                                  Signature{"Kaydara FBX", "FBX"},
                                  Signature{"<?xml", "XML"},
                                  Signature{"{", "JSON"},
                                  Signature{"PK\x03\x04", "a ZIP archive"},
                                  Signature{"\x1f\x8b", "a gzip archive"},
                                  Signature{"\x89HDF", "HDF5"},
                                  Signature{"\x89PNG", "PNG"},
                                  Signature{"%PDF", "PDF"}};

Error unsupported(const std::string& path, const std::string& what) {
  return {Fault::kBadInput,
          fmt::format("{}: offset 0: found {}, expected {}", path, what, readable_formats())};
}

/// The first format to which a file that begins so looks like this; null for none.
const Format* format_like(std::string_view start, Likeness likeness) {
  for (const Format* format : kFormats)
    if (format->probe(start) == likeness) return format;
  return nullptr;
}

Result<const Format*> format_of(const std::string& path, std::string_view start) {
  if (start.empty()) return unsupported(path, "an empty file");
  if (const Format* format = format_like(start, Likeness::kCertain)) return format;
  for (const Signature& signature : kUnsupported)
    if (start.starts_with(signature.start)) return unsupported(path, signature.name);
  // A PTX file is text whose first lines are no points.
  if (extension_of(path) == "ptx") return unsupported(path, "PTX");
  if (const Format* format = format_like(start, Likeness::kPossible)) return format;
  return unsupported(path, "bytes of no known format");
}

Result<std::string> read_start(const std::string& path) {
  std::string start(kSniffed, '\0');
  PSS_ASSIGN(const File file, File::open(path));
  PSS_ASSIGN(const std::size_t got, file.read_some(0, std::as_writable_bytes(std::span(start))));
  start.resize(got);
  return start;
}

}  // namespace

Result<std::unique_ptr<Reader>> open_reader(const std::string& path) {
  return open_reader_holding(HeadBytes::kKept, path);
}

Result<std::unique_ptr<Reader>> open_reader_holding(HeadBytes bytes, const std::string& path) {
  PSS_ASSIGN(const std::string start, read_start(path));
  PSS_ASSIGN(const Format* format, format_of(path, start));
  return format->open(bytes, path);
}

Result<const Format*> format_for(const std::string& path) {
  const Format* format = format_by_extension(path);
  if (format && format->create) return format;
  return Error{Fault::kUsage,
               fmt::format("{}: found the extension '{}', expected {}, which tells the format to "
                           "write",
                           path, extension_of(path), writable_extensions())};
}

Result<void> check_grid_options(const std::string& path, const Format* format, bool scale,
                                bool offset) {
  if ((format && format->integer_grid) || (!scale && !offset)) return {};
  return Error{Fault::kUsage,
               fmt::format("{}: {} has no meaning for it, as only {} has a grid; leave it out",
                           path, scale ? "--scale" : "--offset", gridded_formats())};
}

Result<void> check_writable(const std::string& path, WriteOptions options) {
  PSS_ASSIGN(const Format* format, format_for(path));
  PSS_TRY(format->plan(path, std::move(options)));
  return {};
}

Result<std::unique_ptr<Writer>> create_writer(const std::string& path, WriteOptions options) {
  PSS_ASSIGN(const Format* format, format_for(path));
  return format->create(path, std::move(options));
}

}  // namespace pss
