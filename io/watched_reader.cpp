#include "io/watched_reader.h"

#include <fmt/format.h>

#include <utility>

#include "io/open.h"

namespace pss {
namespace {

class WatchedReader : public Reader {
 public:
  WatchedReader(std::unique_ptr<Reader> reader, const InputRecord& expected,
                std::optional<std::uint64_t> count)
      : reader_(std::move(reader)), expected_(expected), count_(count) {}

  const CloudHeader& header() const override { return reader_->header(); }

  std::size_t unit() const override { return reader_->unit(); }

  Result<void> read(std::size_t max, PointBatch& batch) override {
    if (auto read = reader_->read(max, batch); !read) return change_or(read.error(), expected_);
    return count_in(max, batch.size());
  }
  Result<void> fetch(std::size_t max, RawPoints& out) override {
    if (auto read = reader_->fetch(max, out); !read) return change_or(read.error(), expected_);
    return count_in(max, out.count);
  }
  void decode(RawPoints& raw) const override { reader_->decode(raw); }

  Result<void> seek(std::uint64_t record) override {
    if (auto done = reader_->seek(record); !done) return change_or(done.error(), expected_);
    next_ = record;
    return {};
  }

 private:
  Result<void> count_in(std::size_t wanted, std::size_t got) {
    next_ += got;
    return got == 0 && wanted > 0 ? check_end() : Result<void>();
  }

  Result<void> check_end() const {
    PSS_TRY(check_unchanged(expected_));
    if (!count_ || next_ == *count_) return {};
    return Error{Fault::kFailed,
                 fmt::format("{}: changed while it was read: found {} points, expected {}; nothing "
                             "was written; run the command again once it is no longer written to",
                             expected_.path, next_, *count_)};
  }

  std::unique_ptr<Reader> reader_;
  InputRecord expected_;
  std::optional<std::uint64_t> count_;
  std::uint64_t next_ = 0;  ///< record
};

}  // namespace

Result<std::unique_ptr<Reader>> open_watched(const InputRecord& expected, HeadBytes bytes,
                                             std::optional<std::uint64_t> count) {
  auto reader = open_reader_holding(bytes, expected.path);
  PSS_TRY(check_unchanged(expected));  // first: what was read of a changed file means nothing
  if (!reader) return std::move(reader).error();
  if (!count) count = (*reader)->header().count;
  return std::unique_ptr<Reader>(
      std::make_unique<WatchedReader>(*std::move(reader), expected, count));
}

}  // namespace pss
