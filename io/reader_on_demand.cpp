#include "io/reader_on_demand.h"

#include <fmt/format.h>

#include "io/watched_reader.h"

namespace pss {

Result<void> ReaderOnDemand::read(std::size_t max, PointBatch& batch) {
  batch.clear();
  if (ended_) return {};
  PSS_TRY(open());
  PSS_TRY(reader_->read(max, batch));
  if (batch.size() > 0 || max == 0) return {};
  ended_ = true;
  reader_.reset();
  return {};
}

Result<void> ReaderOnDemand::seek(std::uint64_t record) {
  ended_ = false;
  if (!reader_ && record == 0) return {};
  PSS_TRY(open());
  return reader_->seek(record);
}

Result<void> ReaderOnDemand::open() {
  if (reader_) return {};
  PSS_ASSIGN(reader_, open_watched(record_, HeadBytes::kLeft, header_.count));
  const CloudHeader& now = reader_->header();
  if (now.schema == header_.schema && now.grid == header_.grid && now.count == header_.count)
    return {};
  // Possible only where size, time and ends were set back, but rows of another size must not pass.
  return Error{Fault::kFailed, fmt::format("{}: changed while it was read: found another header "
                                           "than before; nothing was written; run the command "
                                           "again once it is no longer written to",
                                           header_.path)};
}

Result<OnDemand> open_on_demand(std::span<const InputRecord> records, std::string_view family) {
  OnDemand opened;
  std::string crs;
  for (const InputRecord& record : records) {
    PSS_ASSIGN(const std::unique_ptr<Reader> reader,
               open_watched(record, opened.carry ? HeadBytes::kLeft : HeadBytes::kKept));
    CloudHeader header = reader->header();
    if (!opened.carry && header.carry.family == family && !header.carry.head.empty())
      opened.carry = std::move(header.carry);
    header.carry = {};
    if (crs.empty())
      crs = header.crs;
    else if (header.crs == crs)
      header.crs.clear();
    opened.readers.push_back(std::make_unique<ReaderOnDemand>(std::move(header), record));
  }
  return opened;
}

}  // namespace pss
