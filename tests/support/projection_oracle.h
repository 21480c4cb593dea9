#pragma once
// The reference of every operator behind one name: what projections are checked against.

#include "tests/support/apss_oracle.h"
#include "tests/support/fast_oracle.h"
#include "tests/support/levin_oracle.h"
#include "tests/support/rimls_oracle.h"

namespace pss::test {

/// Projects the point at offset zero as docs/algorithm.md reads, computed in `Real`.
///
/// Shape: `offsets` hold at least all points within reach of it; normals one each where the
///        operator needs them. The method's precision has no meaning here.
template <class Real>
Projection project_by_oracle(std::span<const World3> offsets, const Support& support,
                             const Method& method, const OracleNormals& normals = {}) {
  const auto cloud = oracle_cloud<Real>(offsets, support, method.weight,
                                        needs_normals(method.op) ? normals : OracleNormals{});
  const Real tolerance{1e-6};
  switch (method.op) {
    case MlsOperator::kLevin:
      return project_onto_polynomial<Real>(cloud, levin_plane(cloud), method.degree);
    case MlsOperator::kFast:
      return project_onto_polynomial<Real>(cloud, fast_plane(cloud), method.degree);
    case MlsOperator::kApss:
      return project_implicit<Real>(cloud, tolerance, apss_step<Real>);
    case MlsOperator::kRimls:
      return project_implicit<Real>(cloud, tolerance, rimls_step<Real>);
  }
  return {};
}

}  // namespace pss::test
