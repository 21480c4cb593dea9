#include "core/symmetric3.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "core/vec3.h"
#include "tests/support/cloud.h"

namespace pss::test {
namespace {

World3 times(const Symmetric3& m, const World3& v) {
  return {m.xx * v[0] + m.xy * v[1] + m.xz * v[2], m.xy * v[0] + m.yy * v[1] + m.yz * v[2],
          m.xz * v[0] + m.yz * v[1] + m.zz * v[2]};
}

void expect_eigen_system(const Symmetric3& m, double scale) {
  const EigenSystem e = eigen_decomposition(m);
  for (std::size_t i = 0; i < 3; ++i) {
    const World3 error = times(m, e.vectors[i]) - e.values[i] * e.vectors[i];
    EXPECT_LE(std::sqrt(dot(error, error)), 4e-15 * scale);
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(dot(e.vectors[i], e.vectors[j]), i == j ? 1 : 0, 4e-15);
  }
  EXPECT_LE(e.values[0], e.values[1]);
  EXPECT_LE(e.values[1], e.values[2]);
}

TEST(EigenDecomposition, AgreesWithEigenOnRandomMatrices) {
  Random random(4);
  for (int i = 0; i < 500; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random.integer(-200, 200)));
    const auto element = [&] { return scale * random.uniform(-1, 1); };
    const Symmetric3 m{element(), element(), element(), element(), element(), element()};
    Eigen::Matrix3d same;
    same << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
    const Eigen::Vector3d expected =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(same).eigenvalues();
    const EigenSystem ours = eigen_decomposition(m);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(ours.values[static_cast<std::size_t>(k)], expected(k), 1e-14 * scale);
    expect_eigen_system(m, scale);
  }
}

TEST(EigenDecomposition, HandlesTiesZerosAndRankOne) {
  expect_eigen_system({}, 1);
  expect_eigen_system({1, 0, 0, 1, 0, 1}, 1);
  expect_eigen_system({2, 1, 1, 2, 1, 2}, 1);   // 1, 1, 4
  expect_eigen_system({1, 2, 3, 4, 6, 9}, 14);  // (1, 2, 3) times itself
  expect_eigen_system({1, 1e-9, 0, 1, 0, 1e-30}, 1);
}

}  // namespace
}  // namespace pss::test
