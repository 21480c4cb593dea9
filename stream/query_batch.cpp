#include "stream/query_batch.h"

#include <cassert>

namespace pss {

void QueryBatch::clear() {
  points_.clear();
  queries_.clear();
  supports_.clear();
  results_.clear();
}

void QueryBatch::add(Status status) { points_.push_back({kNoQuery, status}); }

void QueryBatch::add(const Index3& position, const Support& support) {
  if (queries_.empty() || queries_.back().position != position) {
    queries_.push_back({position, {0, 0, 0}});
    supports_.push_back(support);
  }
  points_.push_back({static_cast<std::uint32_t>(queries_.size() - 1), Status::kOk});
}

void QueryBatch::project(Projector& projector) {
  results_.resize(queries_.size());
  if (!queries_.empty()) projector.project(queries_, supports_, results_);
}

Projection QueryBatch::answer(std::size_t i) const {
  const Point& point = points_[i];
  if (point.query != kNoQuery) return results_[point.query];
  Projection projection;
  projection.status = point.status;
  return projection;
}

std::size_t QueryBatch::bytes_for(std::size_t points) {
  // Arrays that grow may have twice the room they need.
  return 2 * points * (sizeof(Point) + sizeof(Query) + sizeof(Support) + sizeof(Projection));
}

}  // namespace pss
