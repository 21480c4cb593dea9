#pragma once
// How a text file of points is laid out: separator, header line, columns.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/result.h"

namespace pss {

struct TextLayout {
  std::string extension;  ///< of the file, lower case, without the dot
  /// ' ': any run of blanks. '\t', ',' or ';': exactly one, blanks around it ignored.
  char separator = ' ';
  std::vector<std::string> comments = {};  ///< lines before the points, as they stand
  /// What precedes the names in the header line ("", "#", "//"); nothing: there is no such line.
  std::optional<std::string> header = {};
  bool counted = false;  ///< a line with the number of points precedes them
  std::vector<std::string> columns = {"x", "y", "z"};  ///< names, each one once
  std::array<std::size_t, 3> axes{0, 1, 2};            ///< the columns of x, y and z

  /// The axis that a column holds, if any.
  std::optional<std::size_t> axis(std::size_t column) const;
  bool operator==(const TextLayout&) const = default;
};

/// Files with more columns are refused.
inline constexpr std::size_t kTextColumnLimit = 1000;

/// Takes a line apart; an empty last cell (a separator at the end of the line) is left out.
void split_cells(std::string_view line, char separator, std::vector<std::string_view>& cells);

/// "#" or "//" where a line begins so, otherwise nothing.
std::string_view comment_prefix(std::string_view line);

/// The layout as bytes for Carry, and back.
std::vector<std::byte> pack(const TextLayout& layout);
/// Errors: kBadInput for other bytes.
Result<TextLayout> unpack_text_layout(std::span<const std::byte> bytes);

}  // namespace pss
