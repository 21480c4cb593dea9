#include "io/formats/ply/ply_format.h"

#include <array>

#include "io/formats/ply/ply_plan.h"
#include "io/formats/ply/ply_reader.h"
#include "io/formats/ply/ply_writer.h"

namespace pss {
namespace {

constexpr std::array<std::string_view, 1> kExtensions{"ply"};

Likeness probe(std::string_view start) {
  const bool marked = start.starts_with("ply\n") || start.starts_with("ply\r");
  return marked ? Likeness::kCertain : Likeness::kNone;
}

Result<std::unique_ptr<Reader>> open(HeadBytes /*bytes*/, const std::string& path) {
  return open_ply(path);  // heads are small
}

Result<std::unique_ptr<Writer>> create(const std::string& path, WriteOptions options) {
  return create_ply(path, options);
}

Result<std::optional<Lattice>> plan(const std::string& path, WriteOptions options) {
  PSS_TRY(plan_ply(path, options));
  return std::nullopt;
}

}  // namespace

constinit const Format kPlyFormat{.name = "PLY",
                                  .extensions = kExtensions,
                                  .probe = probe,
                                  .open = open,
                                  .create = create,
                                  .plan = plan,
                                  .family = "PLY"};

}  // namespace pss
