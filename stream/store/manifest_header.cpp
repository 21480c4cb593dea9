// The bytes of a manifest's first record.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "stream/store/bytes.h"
#include "stream/store/lattice_bytes.h"
#include "stream/store/manifest.h"

namespace pss {
namespace {

/// Values as ByteWriter writes them; `Take` gets the bytes, to keep, count or compare them.
template <class Take>
class Encoder {
 public:
  explicit Encoder(Take take) : take_(std::move(take)) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void put(T value) { take_(std::as_bytes(std::span(&value, 1))); }

  void bytes(std::span<const std::byte> bytes) {
    put(static_cast<std::uint32_t>(bytes.size()));
    take_(bytes);
  }
  void text(std::string_view text) { bytes(std::as_bytes(std::span(text))); }

 private:
  Take take_;
};

template <class Writer>
void put(Writer& w, const Field& field) {
  w.text(field.name);
  w.put(static_cast<std::uint8_t>(field.type));
  w.put(field.count);
  w.put(field.scale);
  w.put(field.offset);
  w.put(static_cast<std::uint32_t>(field.bits.size()));
  for (const BitField& bits : field.bits) {
    w.text(bits.name);
    w.put(bits.shift);
    w.put(bits.width);
  }
}

Field get_field(ByteReader& r) {
  Field field;
  field.name = r.text();
  const auto type = r.get<std::uint8_t>();
  if (type > static_cast<std::uint8_t>(Type::kFloat64)) return r.fail(), field;
  field.type = static_cast<Type>(type);
  field.count = r.get<std::uint32_t>();
  if (field.count == 0 || field.count > kMaxRowSize) return r.fail(), field;
  field.scale = r.get<double>();
  field.offset = r.get<double>();
  const std::size_t bits = r.count(6);
  for (std::size_t i = 0; i < bits && r.ok(); ++i) {
    BitField& b = field.bits.emplace_back();
    b.name = r.text();
    b.shift = r.get<std::uint8_t>();
    b.width = r.get<std::uint8_t>();
    if (b.width == 0 || b.shift + b.width > 8 * size_of(field.type) || is_float(field.type))
      r.fail();
  }
  return field;
}

template <class Writer>
void put(Writer& w, const Schema& schema) {
  w.put(static_cast<std::uint32_t>(schema.fields().size()));
  for (const Field& field : schema.fields()) put(w, field);
}

Schema get_schema(ByteReader& r) {
  const std::size_t count = r.count(29);
  std::vector<Field> fields;
  std::size_t row_size = 0;
  for (std::size_t i = 0; i < count && r.ok(); ++i) {
    fields.push_back(get_field(r));
    row_size += fields.back().size();
    if (row_size > kMaxRowSize) r.fail();
  }
  return r.ok() ? Schema(std::move(fields)) : Schema();
}

/// After the format version and the producer.
StoreHeader get_header(ByteReader& r) {
  StoreHeader h;
  h.lattice = get_lattice(r);
  h.schema = get_schema(r);
  h.tile_points = r.get<std::uint32_t>();
  if (h.tile_points == 0) r.fail();
  h.ordered = r.get<std::uint8_t>() != 0;
  if (r.get<std::uint8_t>() != 0) h.grid = get_lattice(r);
  h.inputs.count = r.get<std::uint64_t>();
  h.inputs.hash.high = r.get<std::uint64_t>();
  h.inputs.hash.low = r.get<std::uint64_t>();
  h.parameters = r.text();
  return h;
}

template <class Take>
void encode(const StoreHeader& header, std::string_view made_by, Take take) {
  Encoder w(std::move(take));
  w.put(kStoreVersion);
  w.text(made_by);
  put_lattice(w, header.lattice);
  put(w, header.schema);
  w.put(header.tile_points);
  w.template put<std::uint8_t>(header.ordered);
  w.template put<std::uint8_t>(header.grid.has_value());
  if (header.grid) put_lattice(w, *header.grid);
  w.put(header.inputs.count);
  w.put(header.inputs.hash.high);
  w.put(header.inputs.hash.low);
  w.text(header.parameters);
}

}  // namespace

std::uint64_t memory_of(const StoreHeader& header) {
  return kHeaderCopies * header.parameters.size();
}

std::string producer() { return "pss " PSS_VERSION; }

std::vector<std::byte> encode_header(const StoreHeader& header, std::string_view made_by) {
  using Bytes = std::span<const std::byte>;
  std::size_t size = 0;
  encode(header, made_by, [&size](Bytes bytes) { size += bytes.size(); });
  std::vector<std::byte> out;
  out.reserve(size);  // growing would hold it thrice
  ByteWriter writer(out);
  encode(header, made_by, [&writer](Bytes bytes) { writer.raw(bytes); });
  return out;
}

bool is_encoded(const StoreHeader& header, std::span<const std::byte> payload,
                std::string_view made_by) {
  bool equal = true;
  encode(header, made_by, [&](std::span<const std::byte> bytes) {
    equal = equal && bytes.size() <= payload.size() &&
            std::ranges::equal(bytes, payload.first(bytes.size()));
    payload = payload.subspan(equal ? bytes.size() : 0);
  });
  return equal && payload.empty();
}

Result<void> check_version(const std::string& path, std::span<const std::byte> payload) {
  const auto version = ByteReader(payload).get<std::uint32_t>();
  if (version == kStoreVersion) return {};
  return Error{Fault::kBadInput,
               fmt::format("{}: store format version {} found, this program reads version {}; "
                           "build the store again from its inputs by pss tile, or use --restart "
                           "where it is a job's",
                           path, version, kStoreVersion)};
}

std::string producer_in(std::span<const std::byte> payload) {
  return ByteReader(payload.subspan(sizeof(kStoreVersion))).text();
}

Result<StoreHeader> decode_header(const std::string& path, std::uint64_t offset,
                                  std::span<const std::byte> payload) {
  PSS_TRY(check_version(path, payload));
  ByteReader reader(payload.subspan(sizeof(kStoreVersion)));
  static_cast<void>(reader.text());  // the producer
  StoreHeader header = get_header(reader);
  if (!reader.finished())
    return Error{Fault::kBadInput, fmt::format("{}: damaged at offset {}: the header record makes "
                                               "no sense",
                                               path, offset)};
  return header;
}

}  // namespace pss
