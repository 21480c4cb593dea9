#pragma once
// How far the work is, as a line of text: for a terminal, for a log, for a program.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pss {

/// One moment of a stage.
struct Snapshot {
  std::string stage;
  std::uint64_t points = 0;
  std::uint64_t total_points = 0;  ///< 0: unknown
  std::uint64_t tiles = 0;
  std::uint64_t total_tiles = 0;  ///< 0: the stage has no tiles
  double seconds = 0;             ///< since the program began
  double points_per_second = 0;   ///< over the last seconds
  std::uint64_t resident_bytes = 0;

  /// Of this stage; empty while the total or the rate is unknown.
  std::optional<double> seconds_left() const;
};

/// "smooth  [#####-----]  52%  1.04 M of 2 M points  21/40 tiles  182 k/s  0:05 left  143 MiB",
/// cut to `columns`.
std::string bar_line(const Snapshot& now, std::size_t columns);

/// "[12 s] smooth: 1.04 M of 2 M points (52%), ..." without a newline.
std::string plain_line(const Snapshot& now);

/// One JSON object: event "progress", and the keys of docs/report.md.
std::string json_line(const Snapshot& now);
/// One JSON object: event "note" and its text.
std::string json_note(std::string_view text);

/// "950", "12.3 k", "1.04 M", "2.5 G".
std::string short_count(double count);
/// "143 MiB".
std::string short_size(std::uint64_t bytes);
/// "0:05", "2:03:04".
std::string short_time(double seconds);
/// "1,234,567".
std::string grouped(std::uint64_t count);

}  // namespace pss
