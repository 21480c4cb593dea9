#pragma once
// A reader whose file is open only while it is read, so that any number of inputs goes.

#include <memory>
#include <utility>

#include "io/reader.h"

namespace pss {

/// Opens its file at the first read and closes it at the end of its points.
///
/// Errors: those of open_reader(); kBadInput where the file is another than when it was looked at.
class ReaderOnDemand : public Reader {
 public:
  explicit ReaderOnDemand(CloudHeader header) : header_(std::move(header)) {}

  const CloudHeader& header() const override { return header_; }
  Result<void> read(std::size_t max, PointBatch& batch) override;
  Result<void> seek(std::uint64_t record) override;

 private:
  Result<void> open();

  CloudHeader header_;
  std::unique_ptr<Reader> reader_;
  bool ended_ = false;
};

}  // namespace pss
