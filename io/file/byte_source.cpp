#include "io/file/byte_source.h"

#include <algorithm>
#include <utility>

namespace pss {
namespace {

constexpr std::size_t kPiece = std::size_t{64} << 10;

}  // namespace

Result<ByteSource> ByteSource::open(const std::string& path) {
  PSS_ASSIGN(File file, File::open(path));
  PSS_ASSIGN(const std::uint64_t size, file.size());
  return ByteSource(std::move(file), size);
}

Result<std::span<const std::byte>> ByteSource::peek(std::size_t least) {
  if (buffered().size() < least) PSS_TRY(fill(least));
  return buffered();
}

std::span<const std::byte> ByteSource::buffered() const {
  if (offset_ < buffer_start_ || offset_ - buffer_start_ > buffer_.size()) return {};
  return std::span(buffer_).subspan(static_cast<std::size_t>(offset_ - buffer_start_));
}

Result<void> ByteSource::fill(std::size_t least) {
  const std::span<const std::byte> rest = buffered();
  const std::size_t kept = rest.size();
  std::copy(rest.begin(), rest.end(), buffer_.begin());
  buffer_start_ = offset_;
  const std::uint64_t unread = left() > kept ? left() - kept : 0;
  buffer_.resize(kept + static_cast<std::size_t>(
                            std::min<std::uint64_t>(unread, std::max(least - kept, kPiece))));
  const std::span<std::byte> fresh = std::span(buffer_).subspan(kept);
  PSS_ASSIGN(const std::size_t got, file_.read_some(offset_ + kept, fresh));
  buffer_.resize(kept + got);
  return {};
}

}  // namespace pss
