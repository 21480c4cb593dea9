#include "core/projector.h"

#include <cassert>
#include <numeric>

#include "core/simd/project.h"

namespace pss {

struct Projector::Workspace {
  simd::Workspace kernels;
  std::vector<std::uint32_t> all, redone, hard, none;
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
  w.redone.clear();
  w.hard.clear();
  const bool single = method_.precision == Precision::kSingle;
  const auto in_double = [&](simd::Search search, const std::vector<std::uint32_t>& which,
                             std::vector<std::uint32_t>& rest) {
    simd::project(batch, Precision::kDouble, search, which, w.kernels, rest);
  };
  if (single)
    simd::project(batch, Precision::kSingle, simd::Search::kEasy, w.all, w.kernels, w.redone);
  in_double(simd::Search::kEasy, single ? w.redone : w.all, w.hard);
  in_double(simd::Search::kWhole, w.hard, w.none);
  assert(w.none.empty());
  for (const std::uint32_t i : w.redone) results[i].redone = true;
}

std::size_t Projector::bytes_for(std::size_t ball_points, MlsOperator op) {
  // A slice of candidates in either form, with normals, the room that rows have beyond their balls,
  // and the loops' small arrays.
  constexpr std::size_t kFixed = 80 * simd::kMostCandidates + (std::size_t{1} << 19);
  // 16 rows and their columns in single, 8 in double: 192 bytes a point each, and a fourth more as
  // buffers grow. Normals fill as many, and rimls keeps three more columns.
  return kFixed + (needs_normals(op) ? 2048 : 1024) * ball_points;
}

}  // namespace pss
