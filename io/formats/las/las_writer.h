#pragma once
// Creates uncompressed LAS files, or carries an input's header, VLRs and EVLRs on.

#include <memory>
#include <optional>
#include <string>

#include "core/result.h"
#include "io/points/writer.h"

namespace pss {

/// Creates a LAS file. Attributes beyond its point format become extra bytes with their VLR.
///
/// With a carried LAS header everything of it is kept that the points and attributes allow; the
/// point format and version rise only where an attribute or the count needs it, which notes() says.
/// Errors: kUsage for a scale or offset that is no grid; kBadInput where the attributes do not fit;
///         kFailed where the file cannot be created.
Result<std::unique_ptr<Writer>> create_las(const std::string& path, WriteOptions options);

/// The grid that create_las() would round positions to. Its errors but kFailed; touches no file.
Result<std::optional<Lattice>> plan_las_grid(const std::string& path, WriteOptions options);

}  // namespace pss
