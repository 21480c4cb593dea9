#include "core/projector.h"

#include <cassert>
#include <numeric>

#include "core/simd/project.h"

namespace pss {

struct Projector::Workspace {
  simd::Workspace kernels;
  Offsets offsets;
  std::vector<std::uint32_t> all, in_double, last;
};

Projector::Projector(const CellGrid& grid, const Method& method, const CloudNormals& normals)
    : grid_(grid), method_(method), normals_(normals), workspace_(std::make_unique<Workspace>()) {}

Projector::~Projector() = default;

void Projector::project(std::span<const Query> queries, std::span<const Support> supports,
                        std::span<Projection> results) {
  assert(supports.size() == 1 || supports.size() == queries.size());
  assert(results.size() == queries.size());
  Workspace& w = *workspace_;
  const simd::Batch batch{grid_, normals_, method_, queries, supports, results};
  w.all.resize(queries.size());
  std::iota(w.all.begin(), w.all.end(), 0u);
  w.in_double.clear();
  w.last.clear();
  const bool single = method_.precision == Precision::kSingle;
  if (single) simd::project_single(batch, w.all, w.kernels, w.in_double);
  simd::project_double(batch, single ? w.in_double : w.all, w.kernels, w.last);
  for (const std::uint32_t i : w.last) {
    grid_.gather(queries[i], reach(method_.weight, batch.support(i)), w.offsets);
    results[i] = project_point(w.offsets, batch.support(i), method_);
  }
  for (const std::uint32_t i : w.in_double) results[i].redone = true;
}

std::size_t Projector::bytes_for(std::size_t ball_points, MlsOperator op) {
  // Normals fill as many rows and columns as points do, and rimls keeps three more columns.
  return (needs_normals(op) ? 2560 : 1024) * ball_points;
}

}  // namespace pss
