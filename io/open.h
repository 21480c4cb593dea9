#pragma once
// Opens and creates files of any format of the table, io/formats/table.h.

#include <memory>
#include <string>

#include "core/result.h"
#include "io/points/format.h"
#include "io/points/reader.h"
#include "io/points/writer.h"

namespace pss {

/// Opens a file by its content, not its name.
///
/// Errors: kFailed where it cannot be opened, kBadInput where it is of no supported format.
Result<std::unique_ptr<Reader>> open_reader(const std::string& path);

/// The same. With kLeft the header's `carry` may be empty, and opening takes little memory, however
/// large the file's head is; `carry_size` tells what it would hold.
Result<std::unique_ptr<Reader>> open_reader_holding(HeadBytes bytes, const std::string& path);

/// The format that a name's extension asks to write. Never null.
///
/// Errors: kUsage for a name that asks for none.
Result<const Format*> format_for(const std::string& path);

/// Refuses a scale or an offset by hand for a format without an integer grid, or for a store
/// (`format` null).
///
/// Errors: kUsage.
Result<void> check_grid_options(const std::string& path, const Format* format, bool scale,
                                bool offset);

/// Whether create_writer() would take these options, as far as no file decides it; touches none.
///
/// Errors: those of format_for() and Format::plan.
Result<void> check_writable(const std::string& path, WriteOptions options);

/// Creates a file of the format that its name asks for.
///
/// Errors: those of format_for() and Format::create.
/// Cost:   the carried header is moved, not copied, from options that are.
Result<std::unique_ptr<Writer>> create_writer(const std::string& path, WriteOptions options);

}  // namespace pss
