#include "io/file/content_hash.h"

#include <algorithm>

namespace pss {
namespace {

constexpr std::uint64_t kPiece = std::uint64_t{4} << 20;

Hash128 hash_of(std::span<const std::byte> bytes) {
  StreamHash hash;
  hash.update(bytes);
  return hash.digest();
}

}  // namespace

void ContentHasher::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const std::uint64_t room = kPiece - size_ % kPiece;
    const auto part = bytes.first(std::min<std::size_t>(bytes.size(), room));
    last_.update(part);
    size_ += part.size();
    bytes = bytes.subspan(part.size());
    if (size_ % kPiece != 0) continue;
    pieces_.push_back(last_.digest());
    last_ = StreamHash();
  }
}

void ContentHasher::patched(std::uint64_t offset, std::uint64_t size) {
  for (std::uint64_t piece = offset / kPiece; piece * kPiece < offset + size; ++piece)
    changed_.insert(static_cast<std::size_t>(piece));
}

Result<void> ContentHasher::hash_again(const File& file, std::size_t piece) {
  const std::uint64_t begin = piece * kPiece;
  std::vector<std::byte> bytes(static_cast<std::size_t>(std::min(kPiece, size_ - begin)));
  PSS_TRY(file.read(begin, bytes));
  pieces_[piece] = hash_of(bytes);
  return {};
}

Result<FileContent> ContentHasher::finish(const File& file) {
  if (size_ % kPiece != 0) pieces_.push_back(last_.digest());
  for (const std::size_t piece : changed_) PSS_TRY(hash_again(file, piece));
  PSS_ASSIGN(const FileState state, file.state());
  return FileContent{size_, state.modified_ns, hash_of(std::as_bytes(std::span(pieces_)))};
}

Result<FileContent> content_of(const std::string& path, Monitor& monitor) {
  PSS_ASSIGN(const File file, File::open(path));
  ContentHasher hasher;
  std::vector<std::byte> buffer(std::size_t{1} << 20);
  for (;;) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    PSS_ASSIGN(const std::size_t got, file.read_some(hasher.size(), buffer));
    if (got == 0) return hasher.finish(file);
    hasher.append(std::span(buffer).first(got));
  }
}

}  // namespace pss
