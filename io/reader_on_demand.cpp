#include "io/reader_on_demand.h"

#include <fmt/format.h>

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
  PSS_ASSIGN(reader_, open_reader(header_.path));
  const CloudHeader& now = reader_->header();
  if (now.schema == header_.schema && now.grid == header_.grid && now.count == header_.count)
    return {};
  return Error{Fault::kBadInput, fmt::format("{}: found another header than before; the file "
                                             "changed while it was read, so start again when it is "
                                             "complete",
                                             header_.path)};
}

}  // namespace pss
