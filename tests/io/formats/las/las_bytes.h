#pragma once
// LAS files made byte by byte for tests, independent of the code that they test.

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace pss::test {

/// Overwrites bytes of a file's content with a little-endian value.
template <class T>
void put(std::string& bytes, std::size_t offset, T value) {
  std::memcpy(bytes.data() + offset, &value, sizeof value);
}

template <class T>
T get(std::string_view bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

/// Record sizes of the point formats 0 to 10, as the specification's tables give them.
inline constexpr std::size_t kRecordSizes[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

inline std::string vlr(std::string_view user, std::uint16_t record, std::string_view content) {
  std::string bytes(54, '\0');
  std::memcpy(bytes.data() + 2, user.data(), user.size());
  put(bytes, 18, record);
  put(bytes, 20, static_cast<std::uint16_t>(content.size()));
  return bytes.append(content);
}

inline std::string evlr(std::string_view user, std::uint16_t record, std::string_view content) {
  std::string bytes(60, '\0');
  std::memcpy(bytes.data() + 2, user.data(), user.size());
  put(bytes, 18, record);
  put(bytes, 20, static_cast<std::uint64_t>(content.size()));
  return bytes.append(content);
}

/// A descriptor of extra bytes; `type` as the specification numbers them.
inline std::string descriptor(std::uint8_t type, std::string_view name, std::uint8_t options = 0,
                              double scale = 0, double offset = 0) {
  std::string bytes(192, '\0');
  put(bytes, 2, type);
  put(bytes, 3, options);
  std::memcpy(bytes.data() + 4, name.data(), name.size());
  put(bytes, 112, scale);
  put(bytes, 136, offset);
  return bytes;
}

struct LasFile {
  int minor = 2;
  int format = 0;
  std::size_t extra = 0;  ///< extra bytes a point
  std::uint32_t points = 3;
  std::string vlrs = {};
  std::uint32_t vlr_count = 0;
  std::string evlrs = {};
  std::uint32_t evlr_count = 0;
};

/// Point i lies at (100 i, -100 i, i) steps of 0.01; its other bytes count up.
inline std::string las(const LasFile& file) {
  const std::size_t header = file.minor >= 5   ? 393
                             : file.minor == 4 ? 375
                             : file.minor == 3 ? 235
                                               : 227;
  const std::size_t record = kRecordSizes[file.format] + file.extra;
  std::string bytes(header, '\0');
  std::memcpy(bytes.data(), "LASF", 4);
  put(bytes, 24, std::uint8_t{1});
  put(bytes, 25, static_cast<std::uint8_t>(file.minor));
  std::memcpy(bytes.data() + 26, "a scanner", 9);
  put(bytes, 90, std::uint16_t{123});
  put(bytes, 92, std::uint16_t{2019});
  put(bytes, 94, static_cast<std::uint16_t>(header));
  put(bytes, 96, static_cast<std::uint32_t>(header + file.vlrs.size()));
  put(bytes, 100, file.vlr_count);
  put(bytes, 104, static_cast<std::uint8_t>(file.format));
  put(bytes, 105, static_cast<std::uint16_t>(record));
  if (file.format < 6) put(bytes, 107, file.points);
  for (std::size_t a = 0; a < 3; ++a) {
    put(bytes, 131 + 8 * a, 0.01);
    put(bytes, 155 + 8 * a, 1000.0 * static_cast<double>(a));
  }
  const double last = file.points == 0 ? 0 : static_cast<double>(file.points - 1);
  const double boxes[] = {last, 0, 1000, 1000 - last, 2000 + last / 100, 2000};
  for (std::size_t i = 0; i < 6; ++i) put(bytes, 179 + 8 * i, boxes[i]);
  bytes += file.vlrs;
  for (std::uint32_t i = 0; i < file.points; ++i) {
    std::string point(record, '\0');
    for (std::size_t b = 0; b < record; ++b) point[b] = static_cast<char>((16 * i + b) & 0x7F);
    put(point, 0, static_cast<std::int32_t>(100 * i));
    put(point, 4, -static_cast<std::int32_t>(100 * i));
    put(point, 8, static_cast<std::int32_t>(i));
    bytes += point;
  }
  if (file.minor >= 5) {
    put(bytes, 375, 2.5e8);  // largest and least GPS time
    put(bytes, 383, 1.5e8);
    put(bytes, 391, std::uint16_t{1500});  // what times count from, in millions of seconds
  }
  if (file.minor >= 4) {
    put(bytes, 235, std::uint64_t{file.evlr_count == 0 ? 0 : bytes.size()});
    put(bytes, 243, file.evlr_count);
    put(bytes, 247, std::uint64_t{file.points});
  }
  return bytes + file.evlrs;
}

}  // namespace pss::test
