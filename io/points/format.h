#pragma once
// What pss knows of a file format: the row that its folder adds to the table in io/formats/table.h.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/lattice.h"
#include "core/result.h"
#include "io/points/reader.h"
#include "io/points/writer.h"

namespace pss {

/// How a file looks to a format, from its first bytes.
enum class Likeness : std::uint8_t {
  kNone,      ///< it is of another format
  kPossible,  ///< nothing speaks against it: text has no mark of its own
  kCertain,   ///< it has the format's mark
};

/// One of the named parts of a file, as a VLR is of LAS.
struct FilePart {
  std::string name;
  std::string type;
  std::uint64_t bytes = 0;
};

/// What a file's head says that files of other formats do not, for `pss info`.
struct Fact {
  std::string name;  ///< the key in JSON
  std::variant<std::uint64_t, std::string, std::vector<FilePart>> value;
};

/// One format. The fields are all that the rest of the program asks of it.
struct Format {
  /// What messages, reports and stores call it, as "LAS".
  std::string_view name;
  /// Of its files' names, in lower case, the usual one first. They choose the format of an output,
  /// and the files of a directory that are inputs; a file that is read is known by its content.
  std::span<const std::string_view> extensions;
  /// How a file looks that begins so: with 4096 bytes, or all that it has, but at least one.
  Likeness (*probe)(std::string_view start);

  /// Opens a file; open_reader_holding() says what of its head is held.
  ///
  /// Errors: kFailed where it cannot be opened, kBadInput where it is damaged or not supported.
  Result<std::unique_ptr<Reader>> (*open)(HeadBytes bytes, const std::string& path);
  /// Creates a file. Null where the format is only read; then plan is, too.
  ///
  /// Errors: those of plan; kFailed where the file cannot be created.
  Result<std::unique_ptr<Writer>> (*create)(const std::string& path, WriteOptions options);
  /// The grid that create() would round positions to, if any. Touches no file.
  ///
  /// Errors: kUsage for a scale or offset that is no grid; kBadInput for attributes that the format
  ///         cannot hold, and for a carried head that cannot be read.
  Result<std::optional<Lattice>> (*plan)(const std::string& path, WriteOptions options);

  /// Whether coordinates are 32-bit integers on a grid: then a scale and an offset can be chosen,
  /// and positions that are not finite, or too far from the offset, cannot be written.
  bool integer_grid = false;
  /// Formats of one family understand each other's Carry.
  std::string_view family;
  /// A point takes at most so many times the bytes that 32-bit coordinates and its row do.
  std::uint64_t bytes_factor = 1;
  /// What a carried head says. Null for nothing.
  std::vector<Fact> (*facts)(const Carry& carry) = nullptr;
};

}  // namespace pss
