#include "io/formats/las/las_crs.h"

#include <fmt/format.h>

#include <algorithm>

#include "io/file/bytes.h"
#include "io/points/wkt.h"

namespace pss {
namespace {

constexpr std::uint16_t kGeoKeys = 34735;
constexpr std::uint16_t kGeoDoubles = 34736;
constexpr std::uint16_t kGeographicType = 2048;
constexpr std::uint16_t kProjectedType = 3072;
constexpr std::uint16_t kUserDefined = 32767;
constexpr std::size_t kMostValues = 16;  ///< of one key; hostile files claim thousands

/// The bytes of a record of user id LASF_Projection.
std::optional<std::span<const std::byte>> projection(const VlrRange& vlrs,
                                                     std::span<const std::byte> bytes,
                                                     std::uint16_t record) {
  for (const Vlr& vlr : vlrs)
    if (vlr.is("LASF_Projection", record)) return payload(vlr, bytes);
  return std::nullopt;
}

struct GeoKey {
  std::uint16_t id, place, count, value;
};

std::vector<GeoKey> geo_keys(std::span<const std::byte> bytes) {
  std::vector<GeoKey> keys;
  for (std::size_t at = 8; at + 8 <= bytes.size(); at += 8)  // entry 0 is the directory's header
    keys.push_back({load_le<std::uint16_t>(bytes, at), load_le<std::uint16_t>(bytes, at + 2),
                    load_le<std::uint16_t>(bytes, at + 4), load_le<std::uint16_t>(bytes, at + 6)});
  return keys;
}

std::string value_of(const GeoKey& key, std::span<const std::byte> doubles) {
  if (key.place == 0) return fmt::format("{}", key.value);
  std::string text;
  for (std::size_t i = 0; i < std::min<std::size_t>(key.count, kMostValues); ++i) {
    const std::size_t at = 8 * (std::size_t{key.value} + i);
    if (at + 8 <= doubles.size()) text += fmt::format("{} ", load_le<double>(doubles, at));
  }
  return text;
}

std::string crs_of_keys(std::span<const std::byte> bytes, std::span<const std::byte> doubles) {
  const std::vector<GeoKey> keys = geo_keys(bytes);
  for (const std::uint16_t id : {kProjectedType, kGeographicType})
    for (const GeoKey& key : keys)
      if (key.id == id && key.place == 0 && key.value != 0 && key.value != kUserDefined)
        return fmt::format("EPSG:{}", key.value);
  std::string text;
  for (const GeoKey& key : keys)
    if (key.id != 0 && (key.place == 0 || key.place == kGeoDoubles))  // citations are free text
      text += fmt::format("{}={};", key.id, value_of(key, doubles));
  return text.empty() ? text : "GeoTIFF:" + text;
}

}  // namespace

std::string crs_of_wkt(std::span<const std::byte> bytes) {
  const std::string wkt = text_in(bytes);
  const std::string comparable = comparable_wkt(wkt);
  return comparable.empty() ? wkt : comparable;
}

std::string las_crs(const VlrRange& vlrs, std::span<const std::byte> head,
                    const std::optional<std::string>& tail_crs) {
  if (const auto wkt = projection(vlrs, head, kWktRecord)) return crs_of_wkt(*wkt);
  if (tail_crs) return *tail_crs;
  const auto keys = projection(vlrs, head, kGeoKeys);
  if (!keys) return {};
  const auto doubles = projection(vlrs, head, kGeoDoubles);
  return crs_of_keys(*keys, doubles.value_or(std::span<const std::byte>{}));
}

}  // namespace pss
