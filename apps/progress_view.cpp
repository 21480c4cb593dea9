#include "apps/progress_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace pss {

namespace {

double share_done(const Snapshot& now) {
  if (now.total_points == 0) return 0;
  return std::min(1.0, static_cast<double>(now.points) / static_cast<double>(now.total_points));
}

std::string points_text(const Snapshot& now) {
  const std::string done = short_count(static_cast<double>(now.points));
  if (now.total_points == 0) return fmt::format("{} points", done);
  return fmt::format("{} of {} points", done, short_count(static_cast<double>(now.total_points)));
}

std::string tiles_text(const Snapshot& now, const char* separator) {
  if (now.total_tiles == 0) return "";
  return fmt::format("{}{}/{} tiles", separator, now.tiles, now.total_tiles);
}

std::string left_text(const Snapshot& now, const char* separator) {
  std::optional<double> left = now.seconds_left();
  return left ? fmt::format("{}{} left", separator, short_time(*left)) : "";
}

std::string numbers_text(const Snapshot& now, const char* separator) {
  return fmt::format("{}{}{}{}/s{}{}{}", points_text(now), tiles_text(now, separator), separator,
                     short_count(now.points_per_second), left_text(now, separator), separator,
                     short_size(now.resident_bytes));
}

}  // namespace

std::optional<double> Snapshot::seconds_left() const {
  if (total_points == 0 || points_per_second <= 0) return std::nullopt;
  const std::uint64_t left = total_points - std::min(points, total_points);
  return static_cast<double>(left) / points_per_second;
}

std::string bar_line(const Snapshot& now, std::size_t columns) {
  constexpr std::size_t kWidth = 20;
  std::string line = fmt::format("{:<8} ", now.stage);
  if (now.total_points > 0) {
    const auto full = static_cast<std::size_t>(share_done(now) * kWidth);
    line += fmt::format("[{:#<{}}{:-<{}}] {:3.0f}%  ", "", full, "", kWidth - full,
                        std::floor(share_done(now) * 100));
  }
  line += numbers_text(now, "  ");
  return line.substr(0, columns);
}

std::string plain_line(const Snapshot& now) {
  const std::string share =
      now.total_points > 0 ? fmt::format(" {:.0f}%,", std::floor(share_done(now) * 100)) : "";
  return fmt::format("[{}] {}:{} {}", short_time(now.seconds), now.stage, share,
                     numbers_text(now, ", "));
}

std::string json_line(const Snapshot& now) {
  nlohmann::ordered_json line{{"event", "progress"},
                              {"stage", now.stage},
                              {"seconds", std::round(now.seconds * 1000) / 1000},
                              {"points", now.points},
                              {"total_points", now.total_points},
                              {"tiles", now.tiles},
                              {"total_tiles", now.total_tiles},
                              {"points_per_second", std::round(now.points_per_second)},
                              {"resident_bytes", now.resident_bytes}};
  if (std::optional<double> left = now.seconds_left()) line["seconds_left"] = std::round(*left);
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string json_note(std::string_view text) {
  nlohmann::ordered_json line{{"event", "note"}, {"text", text}};
  return line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string short_count(double count) {
  constexpr const char* kUnits[] = {"", " k", " M", " G", " T"};
  std::size_t unit = 0;
  while (count >= 999.5 && unit + 1 < std::size(kUnits)) {
    count /= 1000;
    ++unit;
  }
  if (unit == 0) return fmt::format("{:.0f}", count);
  const int digits = count < 9.995 ? 2 : count < 99.95 ? 1 : 0;
  return fmt::format("{:.{}f}{}", count, digits, kUnits[unit]);
}

std::string short_size(std::uint64_t bytes) {
  constexpr double kMiB = 1 << 20;
  const double mebibytes = static_cast<double>(bytes) / kMiB;
  if (mebibytes >= 10240) return fmt::format("{:.1f} GiB", mebibytes / 1024);
  return fmt::format("{:.{}f} MiB", mebibytes, mebibytes < 10 ? 1 : 0);
}

std::string short_time(double seconds) {
  const auto whole = static_cast<std::uint64_t>(std::clamp(seconds + 0.5, 0.0, 1e12));
  const std::uint64_t hours = whole / 3600;
  const std::uint64_t minutes = whole / 60 % 60;
  if (hours == 0) return fmt::format("{}:{:02}", minutes, whole % 60);
  return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
}

std::string grouped(std::uint64_t count) {
  std::string digits = fmt::format("{}", count);
  for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, 1, ',');
  return digits;
}

}  // namespace pss
