#include "io/las_crs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "io/bytes.h"

namespace pss {
namespace {

constexpr std::uint16_t kWkt = 2112;
constexpr std::uint16_t kGeoKeys = 34735;
constexpr std::uint16_t kGeoDoubles = 34736;
constexpr std::uint16_t kGeographicType = 2048;
constexpr std::uint16_t kProjectedType = 3072;
constexpr std::uint16_t kUserDefined = 32767;
constexpr std::size_t kMostValues = 16;  ///< of one key; hostile files claim thousands

/// The bytes of a record of user id LASF_Projection.
std::optional<std::span<const std::byte>> projection(std::span<const Vlr> vlrs,
                                                     std::span<const std::byte> bytes,
                                                     std::uint16_t record) {
  for (const Vlr& vlr : vlrs)
    if (vlr.is("LASF_Projection", record)) return payload(vlr, bytes);
  return std::nullopt;
}

/// The text within the brackets that follow `keyword`, or nothing.
std::string_view brackets_after(std::string_view wkt, std::string_view keyword) {
  const std::size_t start = wkt.find(keyword);
  if (start == std::string_view::npos) return {};
  const std::size_t open = start + keyword.size();
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = open; i < wkt.size(); ++i) {
    if (wkt[i] == '"') quoted = !quoted;
    if (quoted) continue;
    if (wkt[i] == '[') ++depth;
    if (wkt[i] == ']' && --depth <= 0) return wkt.substr(open, i - open);
  }
  return {};
}

/// The digits of the last AUTHORITY["EPSG","n"] or ID["EPSG",n] that is a direct child.
std::string direct_code(std::string_view node) {
  std::string code;
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < node.size(); ++i) {
    if (node[i] == '"') quoted = !quoted;
    if (quoted) continue;
    if (node[i] == ']') --depth;
    if (node[i] != '[') continue;
    if (++depth != 2) continue;
    const std::string_view before = node.substr(0, i);
    const std::string_view inside = node.substr(i + 1);
    if (!(before.ends_with("AUTHORITY") || before.ends_with(",ID"))) continue;
    if (!inside.starts_with("\"EPSG\",")) continue;
    code.clear();
    for (const char c : inside.substr(7, inside.find(']') - 7))
      if (c >= '0' && c <= '9') code += c;
  }
  return code;
}

std::string without_space(std::string_view text) {
  std::string result;
  bool quoted = false;
  for (const char c : text) {
    if (c == '"') quoted = !quoted;
    if (quoted || !(c == ' ' || c == '\t' || c == '\r' || c == '\n')) result += c;
  }
  return result;
}

std::string crs_of_wkt(std::span<const std::byte> bytes) {
  const std::string wkt = without_space(text_in(bytes));
  const std::string code = epsg_of_wkt(wkt);
  return code.empty() ? wkt : code;
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

std::string epsg_of_wkt(std::string_view wkt) {
  constexpr std::array kKeywords{"PROJCRS", "PROJCS", "GEOGCRS", "GEODCRS", "GEOGCS"};
  for (const char* keyword : kKeywords) {
    const std::string_view node = brackets_after(wkt, keyword);
    if (node.empty()) continue;
    const std::string code = direct_code(node);
    return code.empty() ? code : "EPSG:" + code;
  }
  return {};
}

std::string las_crs(std::span<const Vlr> vlrs, std::span<const std::byte> head,
                    std::span<const Vlr> evlrs, std::span<const std::byte> tail) {
  if (const auto wkt = projection(vlrs, head, kWkt)) return crs_of_wkt(*wkt);
  if (const auto wkt = projection(evlrs, tail, kWkt)) return crs_of_wkt(*wkt);
  const auto keys = projection(vlrs, head, kGeoKeys);
  if (!keys) return {};
  const auto doubles = projection(vlrs, head, kGeoDoubles);
  return crs_of_keys(*keys, doubles.value_or(std::span<const std::byte>{}));
}

}  // namespace pss
