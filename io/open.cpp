// open_reader(), create_writer() and format_for() of io/points/reader.h and io/points/writer.h:
// which format.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "io/file/file.h"
#include "io/formats/las/las_header.h"
#include "io/formats/las/las_reader.h"
#include "io/formats/las/las_writer.h"
#include "io/formats/ply/ply_plan.h"
#include "io/formats/ply/ply_reader.h"
#include "io/formats/ply/ply_writer.h"
#include "io/formats/text/text_layout.h"
#include "io/formats/text/text_plan.h"
#include "io/formats/text/text_reader.h"
#include "io/formats/text/text_writer.h"
#include "io/points/reader.h"
#include "io/points/writer.h"

namespace pss {
namespace {

constexpr std::size_t kSniffed = 4096;

struct Signature {
  std::string_view start;
  const char* format;
};

/// Formats that point clouds come in, or files that are taken for them, and we cannot read.
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

/// Text has no control characters but those that break lines and columns.
bool looks_like_text(std::string_view start) {
  return std::ranges::all_of(start, [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return (byte >= 0x20 && byte != 0x7F) || c == '\n' || c == '\r' || c == '\t' || c == '\f';
  });
}

Error unsupported(const std::string& path, const std::string& what) {
  return {Fault::kBadInput, fmt::format("{}: offset 0: found {}, expected LAS, PLY or text (xyz, "
                                        "csv, txt, pts)",
                                        path, what)};
}

}  // namespace

Result<std::unique_ptr<Reader>> open_reader(const std::string& path) {
  return open_reader_holding(HeadBytes::kKept, path);
}

Result<std::unique_ptr<Reader>> open_reader_holding(HeadBytes bytes, const std::string& path) {
  std::string start(kSniffed, '\0');
  PSS_ASSIGN(const File file, File::open(path));
  PSS_ASSIGN(const std::size_t got, file.read_some(0, std::as_writable_bytes(std::span(start))));
  start.resize(got);
  if (start.empty()) return unsupported(path, "an empty file");
  if (is_las(std::as_bytes(std::span(start)))) return open_las_holding(bytes, path);
  if (start.starts_with("ply\n") || start.starts_with("ply\r")) return open_ply(path);
  for (const Signature& signature : kUnsupported)
    if (start.starts_with(signature.start)) return unsupported(path, signature.format);
  // A PTX file is text whose first lines are no points.
  if (extension_of(path) == "ptx") return unsupported(path, "PTX");
  if (!looks_like_text(start)) return unsupported(path, "bytes of no known format");
  return open_text(path);
}

Result<Format> format_for(const std::string& path) {
  const std::string extension = extension_of(path);
  if (extension == "las") return Format::kLas;
  if (extension == "ply") return Format::kPly;
  for (const char* text : {"xyz", "txt", "csv", "asc", "pts"})
    if (extension == text) return Format::kText;
  return Error{Fault::kUsage,
               fmt::format("{}: found the extension '{}', expected las, ply, xyz, txt, csv, asc or "
                           "pts, which tells the format to write",
                           path, extension)};
}

Result<void> check_grid_options(const std::string& path, std::optional<Format> format, bool scale,
                                bool offset) {
  if (format == Format::kLas || (!scale && !offset)) return {};
  return Error{Fault::kUsage,
               fmt::format("{}: {} has no meaning for it, as only LAS has a grid; leave it out",
                           path, scale ? "--scale" : "--offset")};
}

Result<void> check_writable(const std::string& path, WriteOptions options) {
  if (options.format == Format::kLas) return check_las(path, std::move(options));
  if (options.format == Format::kPly) PSS_TRY(plan_ply(path, options));
  if (options.format == Format::kText) PSS_TRY(plan_text(path, options));
  return {};
}

Result<std::unique_ptr<Writer>> create_writer(const std::string& path, WriteOptions options) {
  switch (options.format) {
    case Format::kLas:
      return create_las(path, std::move(options));
    case Format::kPly:
      return create_ply(path, options);
    case Format::kText:
      return create_text(path, options);
  }
  return Error{Fault::kUsage, fmt::format("{}: no such format", path)};
}

}  // namespace pss
