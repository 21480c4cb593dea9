#pragma once
// A part of a file, read at any place through a buffer of moderate size.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/result.h"
#include "io/file/file.h"

namespace pss {

/// The bytes of a file before an end; the file outlives it.
class FileWindow {
 public:
  /// Reads at least `piece` bytes at once, where there are so many.
  FileWindow(const File& file, std::uint64_t end, std::size_t piece)
      : file_(file), end_(end), piece_(piece) {}

  std::uint64_t end() const { return end_; }

  /// The bytes [offset, offset + count), valid until the next call; empty where they do not all lie
  /// before the end. Requires: `count` has a bound of its own, or of the file's true size.
  Result<std::span<const std::byte>> at(std::uint64_t offset, std::size_t count) {
    if (offset > end_ || count > end_ - offset) return std::span<const std::byte>();
    if (offset < start_ || offset + count > start_ + buffer_.size()) {
      start_ = offset;
      buffer_.resize(static_cast<std::size_t>(
          std::min<std::uint64_t>(std::max(count, piece_), end_ - offset)));
      PSS_TRY(file_.read(offset, buffer_));
    }
    return std::span<const std::byte>(buffer_).subspan(static_cast<std::size_t>(offset - start_),
                                                       count);
  }

 private:
  const File& file_;
  std::uint64_t end_;
  std::size_t piece_;
  std::uint64_t start_ = 0;
  std::vector<std::byte> buffer_;
};

}  // namespace pss
