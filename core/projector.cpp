#include "core/projector.h"

#include <cassert>

namespace pss {

struct Projector::Workspace {
  Offsets offsets;
};

Projector::Projector(const CellGrid& grid, const Method& method, const CloudNormals& normals)
    : grid_(grid), method_(method), normals_(normals), workspace_(std::make_unique<Workspace>()) {}

Projector::~Projector() = default;

void Projector::project(std::span<const Query> queries, std::span<const Support> supports,
                        std::span<Projection> results) {
  assert(supports.size() == 1 || supports.size() == queries.size());
  assert(results.size() == queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const Support& support = supports[supports.size() == 1 ? 0 : i];
    grid_.gather(queries[i], reach(method_.weight, support), workspace_->offsets);
    results[i] = project_levin(workspace_->offsets, support, method_.degree);
  }
}

std::size_t Projector::bytes_for(std::size_t ball_points) { return 256 * ball_points; }

}  // namespace pss
