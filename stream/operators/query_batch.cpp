#include "stream/operators/query_batch.h"

#include <span>

namespace pss {

namespace {

template <class T>
void keep_last(std::vector<T>& values) {
  if (values.size() > 1) values.erase(values.begin(), values.end() - 1);
}

}  // namespace

void QueryBatch::clear() {
  points_.clear();
  keep_last(queries_);
  keep_last(supports_);
  keep_last(results_);
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
  const std::size_t asked = results_.size();
  if (asked == queries_.size()) return;
  results_.resize(queries_.size());
  projector.project(std::span(queries_).subspan(asked), std::span(supports_).subspan(asked),
                    std::span(results_).subspan(asked));
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
