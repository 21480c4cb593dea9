#pragma once
// Readers whose files are open only while they are read, so that any number of inputs goes.

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "io/file/fingerprint.h"
#include "io/points/reader.h"

namespace pss {

/// Opens its file at the first read and closes it at the end of its points.
///
/// Errors: those of open_watched(): kFailed where the file changed since its record was taken.
class ReaderOnDemand : public Reader {
 public:
  ReaderOnDemand(CloudHeader header, InputRecord record)
      : header_(std::move(header)), record_(std::move(record)) {}

  const CloudHeader& header() const override { return header_; }
  Result<void> read(std::size_t max, PointBatch& batch) override;
  Result<void> seek(std::uint64_t record) override;

 private:
  Result<void> open();

  CloudHeader header_;
  InputRecord record_;
  std::unique_ptr<Reader> reader_;
  bool ended_ = false;
};

/// What is kept of many files that are to be read.
struct OnDemand {
  std::vector<std::unique_ptr<Reader>> readers;
  std::optional<Carry> carry;  ///< of the first file of the family that was asked for
};

/// Readers of the files with these records. What a header carries to another file is kept of the
/// first file of this family of formats alone, and of equal coordinate systems the first: only
/// those are used, and thousands add up.
Result<OnDemand> open_on_demand(std::span<const InputRecord> records, std::string_view family);

}  // namespace pss
