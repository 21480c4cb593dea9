#include "io/formats/ply/ply_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "io/file/file.h"
#include "io/formats/ply/ply_bodies.h"
#include "io/formats/ply/ply_format.h"

namespace pss {
namespace {

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Result<std::vector<std::byte>> read_head(const File& file, std::uint64_t size) {
  std::vector<std::byte> head(
      static_cast<std::size_t>(std::min<std::uint64_t>(size, kPlyHeaderLimit)));
  PSS_ASSIGN(const std::size_t got, file.read_some(0, head));
  head.resize(got);
  return head;
}

std::vector<std::string> list_warnings(const PlyElement& vertices) {
  std::vector<std::string> warnings;
  for (const PlyProperty& property : vertices.properties)
    if (property.length_type)
      warnings.push_back(
          fmt::format("list property '{}' of the vertices is skipped", property.name));
  return warnings;
}

std::vector<std::string> warnings_of(const PlyHeader& header, std::size_t vertex) {
  std::vector<std::string> warnings = list_warnings(header.elements[vertex]);
  for (std::size_t i = 0; i < header.elements.size(); ++i)
    if (i != vertex && header.elements[i].count != 0)
      warnings.push_back(fmt::format("element '{}' is skipped ({} entries)",
                                     header.elements[i].name, header.elements[i].count));
  return warnings;
}

CloudHeader cloud_header(const std::string& path, const PlyHeader& header, std::size_t vertex,
                         std::vector<std::byte> head) {
  CloudHeader cloud;
  cloud.path = path;
  cloud.format = kPlyFormat.name;
  cloud.count = header.elements[vertex].count;
  head.resize(static_cast<std::size_t>(header.size));
  cloud.carry_size = head.size();
  cloud.carry = {.family = std::string(kPlyFormat.family), .head = std::move(head), .tail = {}};
  cloud.warnings = warnings_of(header, vertex);
  return cloud;
}

/// Refuses a count that the file's size cannot hold, so that nothing is allocated by a claim.
Result<void> check_count(const PlyFile& file) {
  const PlyElement& vertices = file.vertices();
  const bool ascii = file.header.encoding == PlyEncoding::kAscii;
  // A number in ascii takes a digit and a separator; the last separator may be missing.
  const std::uint64_t left = file.size - file.header.size + (ascii ? 1 : 0);
  const std::uint64_t most = left / (ascii ? 2 * vertices.properties.size() : least_size(vertices));
  if (vertices.count <= most) return {};
  return Error{Fault::kBadInput,
               fmt::format("{}: the header promises {} vertices, but after it (offset {}) the file "
                           "has room for at most {}; the file is cut short or its header is wrong",
                           file.cloud.path, vertices.count, file.header.size, most)};
}

}  // namespace

Result<void> PlyReader::read(std::size_t max, PointBatch& batch) {
  const std::uint64_t left = file_.vertices().count - next_;
  const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(max, left));
  batch.clear();
  batch.first_record = next_;
  batch.world.resize(count);
  batch.rows.resize(count * file_.layout.schema.row_size());
  if (count == 0) return {};
  PSS_TRY(fill(batch));
  next_ += count;
  return {};
}

Result<void> PlyReader::seek(std::uint64_t record) {
  if (record > file_.vertices().count)
    return Error{Fault::kBadInput, fmt::format("{}: has {} vertices, but vertex {} was asked for",
                                               file_.cloud.path, file_.vertices().count, record)};
  PSS_TRY(go_to(record));
  next_ = record;
  return {};
}

Error PlyReader::short_of(std::uint64_t record) const {
  return {Fault::kBadInput,
          fmt::format("{}: the file ends at offset {}, within or before vertex {} of the {} that "
                      "its header promises; the file is cut short or its header is wrong",
                      file_.cloud.path, file_.size, record, file_.vertices().count)};
}

Result<std::unique_ptr<Reader>> open_ply(const std::string& path) {
  PSS_ASSIGN(File input, File::open(path));
  PSS_ASSIGN(const std::uint64_t size, input.size());
  PSS_ASSIGN(std::vector<std::byte> head, read_head(input, size));
  PSS_ASSIGN(PlyHeader header, parse_ply_header(as_text(head), path));
  const auto vertex = header.find("vertex");
  if (!vertex)
    return Error{Fault::kBadInput, fmt::format("{}: the PLY header has no element 'vertex', so "
                                               "there are no points to read",
                                               path)};
  PSS_ASSIGN(PlyLayout layout, ply_layout(header.elements[*vertex], path));
  CloudHeader cloud = cloud_header(path, header, *vertex, std::move(head));
  cloud.schema = layout.schema;
  PlyFile file{ByteSource(std::move(input), size),
               size,
               std::move(header),
               *vertex,
               std::move(layout),
               std::move(cloud)};
  PSS_TRY(check_count(file));
  file.bytes.seek(file.header.size);
  if (file.header.encoding == PlyEncoding::kAscii) return read_ply_text(std::move(file));
  return read_ply_bytes(std::move(file));
}

}  // namespace pss
