#pragma once
// The lines of a text file, one after another, whichever way they end.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/result.h"
#include "io/file/byte_source.h"

namespace pss {

/// A place in a text file.
struct LinePlace {
  std::uint64_t offset = 0;
  std::uint64_t line = 0;  ///< lines before it
};

/// Lines end with "\n", "\r\n" or "\r"; the last one may lack its end.
class LineSource {
 public:
  explicit LineSource(ByteSource bytes) : bytes_(std::move(bytes)) {}

  const std::string& path() const { return bytes_.path(); }
  std::uint64_t size() const { return bytes_.size(); }

  /// The next line without its end, valid until the next call; nothing at the end of the file.
  ///
  /// Errors: kBadInput for a line longer than 1 MiB.
  Result<std::optional<std::string_view>> next();

  LinePlace place() const { return {bytes_.offset(), line_}; }
  void go_to(const LinePlace& place);

  /// kBadInput at the line that next() gave last: "path: line 12 (offset 345): message".
  Error error(std::string_view message) const;

 private:
  Error too_long();

  ByteSource bytes_;
  std::uint64_t line_ = 0;
  std::uint64_t start_ = 0;  ///< offset of the last line
};

/// The tokens of a line that blanks separate, one after another; empty after the last one.
std::string_view next_token(std::string_view& rest);
/// A text without the blanks around it.
std::string_view trimmed(std::string_view text);

}  // namespace pss
