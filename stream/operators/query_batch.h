#pragma once
// Some points of a part as queries of one call: places once, points without a question not at all.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/projector.h"

namespace pss {

/// Queries in the order of their points, and which of them answers for which point.
class QueryBatch {
 public:
  /// Forgets all points; the last answer is kept for more points of its place.
  ///
  /// Requires: the cloud and the place's support stay the same.
  void clear();

  /// A point whose status is known without looking at its neighbours.
  void add(Status status);
  /// A point that is to be projected. The same place as the last one's is the same question.
  ///
  /// Requires: one support a place.
  void add(const Index3& position, const Support& support);

  /// Asks all new questions in one call.
  void project(Projector& projector);

  /// The answer for the point that was added as number `i`.
  Projection answer(std::size_t i) const;

  /// What a batch of `points` points holds.
  static std::size_t bytes_for(std::size_t points);

 private:
  struct Point {
    std::uint32_t query;  ///< kNoQuery where the status is known
    Status status;
  };
  static constexpr std::uint32_t kNoQuery = 0xffffffff;

  std::vector<Point> points_;
  std::vector<Query> queries_;
  std::vector<Support> supports_;
  std::vector<Projection> results_;  ///< of queries that have been asked
};

}  // namespace pss
