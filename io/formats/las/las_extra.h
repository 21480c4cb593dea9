#pragma once
// Extra bytes of LAS records: attributes beyond the point format, described by a VLR.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "io/formats/las/las_schema.h"
#include "io/formats/las/las_vlr.h"

namespace pss {

inline constexpr std::size_t kDescriptorSize = 192;
inline constexpr std::uint16_t kExtraBytesRecord = 4;  ///< of user id "LASF_Spec"

/// An attribute of extra bytes; `descriptor` as it stands in the file that it comes from.
struct ExtraField {
  Field field;
  std::optional<std::array<std::byte, kDescriptorSize>> descriptor;
};

/// Reads descriptors for `size` extra bytes; what they leave undescribed is one field of bytes.
///
/// Names are made unique, also against `standard`; what was odd is told in `warnings`.
std::vector<ExtraField> read_extra_fields(std::span<const std::byte> descriptors, std::size_t size,
                                          const Schema& standard,
                                          std::vector<std::string>& warnings);

/// The descriptors of all extra-bytes VLRs, one behind the other.
std::vector<std::byte> extra_descriptors(const VlrRange& vlrs, std::span<const std::byte> head);

/// Whether a descriptor can be made for a field.
bool can_describe(const Field& field);
/// Appends the field's own descriptor, or a new one (several for more than 255 undescribed bytes).
///
/// Requires: can_describe(extra.field).
void append_descriptors(const ExtraField& extra, std::vector<std::byte>& out);

/// The row of a LAS record: the standard fields and these.
Schema las_schema(std::uint8_t point_format, std::span<const ExtraField> extra);

}  // namespace pss
