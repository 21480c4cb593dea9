#pragma once
// Reads the points of one file in order, in bounded memory, whatever the format.

#include <cstdint>

#include "core/result.h"
#include "io/points/points.h"

namespace pss {

class Reader {
 public:
  virtual ~Reader() = default;

  virtual const CloudHeader& header() const = 0;

  /// Replaces `batch` by at most `max` following points; an empty batch means the end.
  ///
  /// Errors: kBadInput where the file is damaged or ends before the points it promised.
  virtual Result<void> read(std::size_t max, PointBatch& batch) = 0;

  /// The most records that the format decodes together, as those of a LAZ chunk: at least 1, and
  /// not more than the header's count. 1 also where all records are decoded in order.
  ///
  /// Nothing of a claim is trusted: whoever fetches asks the memory limit for so many first.
  virtual std::size_t unit() const { return 1; }

  /// read() in two steps, for those who decode on many threads: `out.count` is how many there are,
  /// 0 only at the end.
  ///
  /// What a format can only read in order is decoded here already. Records that are decoded
  /// together are fetched together: a reader gives fewer than `max` rather than cut them. Where
  /// `max` is less than what is left of them, it gives that many, and decodes them all for it.
  /// Errors: those of read().
  virtual Result<void> fetch(std::size_t max, RawPoints& out) {
    PSS_TRY(read(max, out.points));
    out.count = out.points.size();
    return {};
  }
  /// Makes the points that were fetched. Thread: any number at once, also beside fetch().
  virtual void decode(RawPoints& /*raw*/) const {}

  /// The next read starts at this record (0 is the first).
  virtual Result<void> seek(std::uint64_t record) = 0;
};

/// Whether a reader holds the bytes that another file would carry on: of the first of many inputs
/// they are wanted, of the others they would only add up.
enum class HeadBytes : std::uint8_t { kKept, kLeft };

}  // namespace pss
