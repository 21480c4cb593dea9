#pragma once
// The bytes of a file, front to back, through a buffer whose size no file decides.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/result.h"
#include "io/file/file.h"

namespace pss {

/// Reads ahead in pieces. What peek() returned is valid until the next peek().
class ByteSource {
 public:
  /// Requires: `size` is the file's.
  ByteSource(File file, std::uint64_t size) : file_(std::move(file)), size_(size) {}
  static Result<ByteSource> open(const std::string& path);

  const std::string& path() const { return file_.path(); }
  std::uint64_t size() const { return size_; }      ///< of the file when it was opened
  std::uint64_t offset() const { return offset_; }  ///< of the next byte
  std::uint64_t left() const { return size_ > offset_ ? size_ - offset_ : 0; }

  /// At least `least` following bytes, or all there are.
  ///
  /// Requires: `least` has a bound of the caller's own, not the file's word.
  Result<std::span<const std::byte>> peek(std::size_t least);

  void skip(std::uint64_t bytes) { offset_ += bytes; }
  void seek(std::uint64_t offset) { offset_ = offset; }

 private:
  std::span<const std::byte> buffered() const;
  Result<void> fill(std::size_t least);

  File file_;
  std::uint64_t size_ = 0;
  std::uint64_t offset_ = 0;
  std::vector<std::byte> buffer_;
  std::uint64_t buffer_start_ = 0;  ///< the file's offset of the buffer's first byte
};

}  // namespace pss
