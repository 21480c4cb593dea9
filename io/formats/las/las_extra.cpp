#include "io/formats/las/las_extra.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstring>
#include <utility>

#include "io/file/bytes.h"

namespace pss {
namespace {

// A descriptor: 2 type u8, 3 options u8, 4 name 32 bytes, 40 no-data, 64 min, 88 max, 112 scale,
// 136 offset (3 x 8 bytes each), 160 description 32 bytes.
constexpr std::size_t kTypeAt = 2;
constexpr std::size_t kOptionsAt = 3;
constexpr std::size_t kNameAt = 4;
constexpr std::size_t kNameSize = 32;
constexpr std::size_t kScaleAt = 112;
constexpr std::size_t kOffsetAt = 136;
constexpr unsigned kHasScale = 8;
constexpr unsigned kHasOffset = 16;
constexpr std::uint32_t kMostUndescribed = 255;
constexpr std::size_t kMostDescriptors = 341;  ///< what one VLR can hold; unique names cost n^3

/// Types 1 to 10; 11 to 20 are pairs and 21 to 30 triples of them (deprecated, but about).
constexpr std::array<Type, 10> kTypes{Type::kUint8,   Type::kInt8,   Type::kUint16, Type::kInt16,
                                      Type::kUint32,  Type::kInt32,  Type::kUint64, Type::kInt64,
                                      Type::kFloat32, Type::kFloat64};

using Descriptor = std::span<const std::byte, kDescriptorSize>;

/// Scale and offset differ by element in arrays; a field has one, so it is taken if they agree.
std::optional<double> common_value(Descriptor d, std::size_t at, std::uint32_t count) {
  const double first = load_le<double>(d, at);
  for (std::uint32_t i = 1; i < count; ++i)
    if (load_le<double>(d, at + 8 * i) != first) return std::nullopt;
  return first;
}

std::string printable(std::string name) {
  std::ranges::replace_if(
      name, [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; }, '_');
  return name;
}

std::string unique_name(std::string name, const Schema& taken) {
  if (!taken.dimension(name) && !taken.find(name)) return name;
  for (int i = 2;; ++i) {
    const std::string numbered = fmt::format("{}_{}", name, i);
    if (!taken.dimension(numbered) && !taken.find(numbered)) return numbered;
  }
}

/// Type and count, or nothing where the type is unknown.
std::optional<Field> plain_field(Descriptor d) {
  const auto type = load_le<std::uint8_t>(d, kTypeAt);
  Field field;
  if (type > 30) return std::nullopt;
  if (type == 0) {
    field.count = load_le<std::uint8_t>(d, kOptionsAt);
  } else {
    field.type = kTypes[(type - 1u) % 10];
    field.count = 1 + (type - 1u) / 10;
  }
  return field;
}

void read_scale(Descriptor d, Field& field, std::vector<std::string>& warnings) {
  if (load_le<std::uint8_t>(d, kTypeAt) == 0) return;
  const auto options = load_le<std::uint8_t>(d, kOptionsAt);
  const auto value = [&](unsigned bit, std::size_t at, double otherwise) -> std::optional<double> {
    return (options & bit) != 0 ? common_value(d, at, field.count) : otherwise;
  };
  const std::optional<double> scale = value(kHasScale, kScaleAt, 1);
  const std::optional<double> offset = value(kHasOffset, kOffsetAt, 0);
  if (scale && offset && std::isnormal(*scale) && std::isfinite(*offset)) {
    field.scale = *scale;
    field.offset = *offset;
  } else {
    warnings.push_back(
        fmt::format("extra bytes '{}': scale or offset make no sense for a whole attribute, so "
                    "values are taken as stored",
                    field.name));
  }
}

using NewDescriptor = std::array<std::byte, kDescriptorSize>;

NewDescriptor raw_descriptor(std::string_view name, std::uint32_t count) {
  NewDescriptor d{};
  std::memcpy(d.data() + kNameAt, name.data(), std::min(name.size(), kNameSize));
  d[kOptionsAt] = static_cast<std::byte>(count);
  return d;
}

NewDescriptor typed_descriptor(const Field& field) {
  NewDescriptor d = raw_descriptor(field.name, 0);
  const auto type = static_cast<unsigned>(std::ranges::find(kTypes, field.type) - kTypes.begin());
  d[kTypeAt] = static_cast<std::byte>(1 + type + 10 * (field.count - 1));
  if (field.scale == 1 && field.offset == 0) return d;
  d[kOptionsAt] = static_cast<std::byte>(kHasScale | kHasOffset);
  for (std::uint32_t i = 0; i < field.count; ++i) {
    store_le(std::span<std::byte>(d), kScaleAt + 8 * i, field.scale);
    store_le(std::span<std::byte>(d), kOffsetAt + 8 * i, field.offset);
  }
  return d;
}

}  // namespace

std::vector<ExtraField> read_extra_fields(std::span<const std::byte> descriptors, std::size_t size,
                                          const Schema& standard,
                                          std::vector<std::string>& warnings) {
  std::vector<ExtraField> all;
  Schema taken = standard;
  const std::size_t count = descriptors.size() / kDescriptorSize;
  for (std::size_t i = 0; i < count; ++i) {
    const auto d = descriptors.subspan(i * kDescriptorSize).first<kDescriptorSize>();
    std::optional<Field> field = plain_field(d);
    if (!field || field->size() > size || i == kMostDescriptors) {
      const char* why = !field                 ? "has an unknown type"
                        : field->size() > size ? "does not fit the record length"
                                               : "is one too many";
      warnings.push_back(
          fmt::format("extra bytes VLR: descriptor {} of {} {}; it and those after it are ignored",
                      i + 1, count, why));
      break;
    }
    if (field->count == 0) continue;
    const std::string name = printable(text_in(d.subspan(kNameAt, kNameSize)));
    field->name = unique_name(name.empty() ? fmt::format("Extra{}", i + 1) : name, taken);
    read_scale(d, *field, warnings);
    size -= field->size();
    taken.add(*field);
    all.push_back({std::move(*field), std::array<std::byte, kDescriptorSize>{}});
    std::ranges::copy(d, all.back().descriptor->begin());
  }
  if (size > 0) {
    Field rest{
        unique_name("ExtraBytes", taken), Type::kUint8, static_cast<std::uint32_t>(size), 1, 0, {}};
    all.push_back({std::move(rest), std::nullopt});
  }
  return all;
}

std::vector<std::byte> extra_descriptors(const VlrRange& vlrs, std::span<const std::byte> head) {
  std::vector<std::byte> all;
  for (const Vlr& vlr : vlrs) {
    if (!vlr.is("LASF_Spec", kExtraBytesRecord)) continue;
    const auto bytes = payload(vlr, head);
    const auto whole = bytes.first(bytes.size() - bytes.size() % kDescriptorSize);
    all.insert(all.end(), whole.begin(), whole.end());
  }
  return all;
}

bool can_describe(const Field& field) {
  return field.bits.empty() && (field.count <= 3 || field.type == Type::kUint8);
}

void append_descriptors(const ExtraField& extra, std::vector<std::byte>& out) {
  const auto append = [&](const auto& d) { out.insert(out.end(), d.begin(), d.end()); };
  if (extra.descriptor) return append(*extra.descriptor);
  assert(can_describe(extra.field));
  if (extra.field.count <= 3) return append(typed_descriptor(extra.field));
  for (std::uint32_t done = 0; done < extra.field.count; done += kMostUndescribed)
    append(raw_descriptor(extra.field.name, std::min(kMostUndescribed, extra.field.count - done)));
}

Schema las_schema(std::uint8_t point_format, std::span<const ExtraField> extra) {
  Schema schema = las_standard_schema(point_format);
  for (const ExtraField& e : extra) schema.add(e.field);
  return schema;
}

}  // namespace pss
