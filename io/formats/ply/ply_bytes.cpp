// The binary half of io/formats/ply/ply_bodies.h.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/formats/ply/ply_bodies.h"
#include "io/points/raw_value.h"

namespace pss {
namespace {

using ValueBytes = std::array<std::byte, 8>;

/// The bytes of a value in little-endian order.
ValueBytes little_endian(std::span<const std::byte> bytes, bool big) {
  ValueBytes value{};
  if (big) {
    std::ranges::reverse_copy(bytes, value.begin());
  } else {
    std::ranges::copy(bytes, value.begin());
  }
  return value;
}

/// Reads properties one at a time, as entries with lists must be.
class Walker {
 public:
  Walker(ByteSource& bytes, bool big) : bytes_(bytes), big_(big) {}

  Result<ValueBytes> scalar(Type type);
  Result<void> skip_list(Type length_type, Type item_type);
  Result<void> skip_elements(const PlyElement& element);

 private:
  Result<void> skip_entry(const PlyElement& element);
  Error cut_short() const;

  ByteSource& bytes_;
  bool big_;
};

Error Walker::cut_short() const {
  return {Fault::kBadInput,
          fmt::format("{}: the data ends too early: {} bytes are left at offset {}, fewer than the "
                      "PLY header and its lists ask for; the file is damaged or cut short",
                      bytes_.path(), bytes_.left(), bytes_.offset())};
}

Result<ValueBytes> Walker::scalar(Type type) {
  const std::size_t size = size_of(type);
  PSS_ASSIGN(const std::span<const std::byte> bytes, bytes_.peek(size));
  if (bytes.size() < size) return cut_short();
  bytes_.skip(size);
  return little_endian(bytes.first(size), big_);
}

Result<void> Walker::skip_list(Type length_type, Type item_type) {
  PSS_ASSIGN(const ValueBytes bytes, scalar(length_type));
  const RawInteger length = load_integer({.name = {}, .type = length_type}, bytes.data(), 0);
  if (length.negative)
    return Error{Fault::kBadInput,
                 fmt::format("{}: before offset {}: found a list of length -{}, expected 0 or more",
                             bytes_.path(), bytes_.offset(), length.magnitude)};
  if (length.magnitude > bytes_.left() / size_of(item_type)) return cut_short();
  bytes_.skip(length.magnitude * size_of(item_type));
  return {};
}

Result<void> Walker::skip_entry(const PlyElement& element) {
  for (const PlyProperty& property : element.properties) {
    if (property.length_type) {
      PSS_TRY(skip_list(*property.length_type, property.type));
    } else {
      PSS_TRY(scalar(property.type));
    }
  }
  return {};
}

Result<void> Walker::skip_elements(const PlyElement& element) {
  const std::size_t size = least_size(element);
  if (size == 0) return {};
  if (element.count > bytes_.left() / size) return cut_short();
  if (!has_lists(element)) {
    bytes_.skip(element.count * size);
    return {};
  }
  for (std::uint64_t i = 0; i < element.count; ++i) PSS_TRY(skip_entry(element));
  return {};
}

class PlyByteReader final : public PlyReader {
 public:
  PlyByteReader(PlyFile file, std::uint64_t start)
      : PlyReader(std::move(file)),
        start_(start),
        size_(least_size(this->file().vertices())),
        lists_(has_lists(this->file().vertices())),
        big_(this->file().header.encoding == PlyEncoding::kBigEndian) {}

 protected:
  Result<void> fill(PointBatch& batch) override;
  Result<void> go_to(std::uint64_t record) override;

 private:
  Result<void> fill_fixed(PointBatch& batch);
  Result<void> walk(World3& position, std::byte* row);
  void decode(const std::byte* vertex, World3& position, std::byte* row);

  std::uint64_t start_;  ///< offset of the first vertex
  std::size_t size_;     ///< of a vertex without its lists' items
  bool lists_;
  bool big_;
};

Result<void> PlyByteReader::fill(PointBatch& batch) {
  if (!lists_) return fill_fixed(batch);
  const std::size_t row_size = file().layout.schema.row_size();
  for (std::size_t i = 0; i < batch.world.size(); ++i)
    PSS_TRY(walk(batch.world[i], batch.rows.data() + i * row_size));
  return {};
}

Result<void> PlyByteReader::fill_fixed(PointBatch& batch) {
  const std::size_t row_size = file().layout.schema.row_size();
  for (std::size_t done = 0; done < batch.world.size();) {
    PSS_ASSIGN(const std::span<const std::byte> bytes, file().bytes.peek(size_));
    const std::size_t got = std::min(bytes.size() / size_, batch.world.size() - done);
    if (got == 0) return short_of(next() + done);
    for (std::size_t i = 0; i < got; ++i, ++done)
      decode(bytes.data() + i * size_, batch.world[done], batch.rows.data() + done * row_size);
    file().bytes.skip(got * size_);
  }
  return {};
}

void PlyByteReader::decode(const std::byte* vertex, World3& position, std::byte* row) {
  for (const PlySlot& slot : file().layout.slots) {
    const std::size_t size = size_of(slot.type);
    if (big_) {
      place_value(slot, little_endian({vertex, size}, true).data(), position, row);
    } else {
      place_value(slot, vertex, position, row);
    }
    vertex += size;
  }
}

Result<void> PlyByteReader::walk(World3& position, std::byte* row) {
  Walker walker(file().bytes, big_);
  for (const PlySlot& slot : file().layout.slots) {
    if (slot.length_type) {
      PSS_TRY(walker.skip_list(*slot.length_type, slot.type));
      continue;
    }
    PSS_ASSIGN(const ValueBytes value, walker.scalar(slot.type));
    place_value(slot, value.data(), position, row);
  }
  return {};
}

Result<void> PlyByteReader::go_to(std::uint64_t record) {
  if (!lists_) {
    file().bytes.seek(start_ + record * size_);
    return {};
  }
  if (record < next()) file().bytes.seek(start_);
  World3 position{};
  std::vector<std::byte> row(file().layout.schema.row_size());
  for (std::uint64_t i = record < next() ? 0 : next(); i < record; ++i)
    PSS_TRY(walk(position, row.data()));
  return {};
}

}  // namespace

Result<std::unique_ptr<Reader>> read_ply_bytes(PlyFile file) {
  const bool big = file.header.encoding == PlyEncoding::kBigEndian;
  Walker walker(file.bytes, big);
  for (std::size_t i = 0; i < file.vertex; ++i)
    PSS_TRY(walker.skip_elements(file.header.elements[i]));
  const std::uint64_t start = file.bytes.offset();
  const std::uint64_t most = file.bytes.left() / least_size(file.vertices());
  if (file.vertices().count > most)
    return Error{Fault::kBadInput,
                 fmt::format("{}: the header promises {} vertices, but from offset {} on the file "
                             "holds {}; the file is cut short or its header is wrong",
                             file.bytes.path(), file.vertices().count, start, most)};
  return std::unique_ptr<Reader>(std::make_unique<PlyByteReader>(std::move(file), start));
}

}  // namespace pss
