#include "core/symmetric3.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace pss {
namespace {

using Matrix3 = std::array<World3, 3>;

/// Rotates in the plane of axes p and q so that element (p, q) becomes zero; `vectors` holds the
/// eigenvectors as rows.
void rotate(Matrix3& a, Matrix3& vectors, std::size_t p, std::size_t q) {
  const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
  const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1);
  const double s = t * c;
  a[p][p] -= t * a[p][q];
  a[q][q] += t * a[p][q];
  a[p][q] = a[q][p] = 0;
  const std::size_t r = 3 - p - q;
  const double arp = a[r][p];
  const double arq = a[r][q];
  a[r][p] = a[p][r] = c * arp - s * arq;
  a[r][q] = a[q][r] = s * arp + c * arq;
  for (std::size_t k = 0; k < 3; ++k) {
    const double vp = vectors[p][k];
    const double vq = vectors[q][k];
    vectors[p][k] = c * vp - s * vq;
    vectors[q][k] = s * vp + c * vq;
  }
}

/// Whether the off-diagonal element no longer matters beside both of its diagonal ones.
bool negligible(const Matrix3& a, std::size_t p, std::size_t q) {
  const double least = std::min(std::abs(a[p][p]), std::abs(a[q][q]));
  return std::abs(a[p][q]) <= std::numeric_limits<double>::min() ||
         std::abs(a[p][q]) <= 0x1p-60 * least;
}

}  // namespace

EigenSystem eigen_decomposition(const Symmetric3& m) {
  constexpr int kMostSweeps = 12;  // convergence is quadratic: four or five do
  Matrix3 a{{{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}}};
  Matrix3 vectors{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  bool done = false;
  for (int sweep = 0; sweep < kMostSweeps && !done; ++sweep) {
    done = true;
    for (const auto& [p, q] : {std::pair<std::size_t, std::size_t>{0, 1}, {0, 2}, {1, 2}}) {
      if (negligible(a, p, q)) continue;
      rotate(a, vectors, p, q);
      done = false;
    }
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  const auto sort_pair = [&](std::size_t i, std::size_t j) {
    if (a[order[j]][order[j]] < a[order[i]][order[i]]) std::swap(order[i], order[j]);
  };
  sort_pair(0, 1);
  sort_pair(1, 2);
  sort_pair(0, 1);
  EigenSystem result;
  for (std::size_t i = 0; i < 3; ++i) {
    result.values[i] = a[order[i]][order[i]];
    result.vectors[i] = vectors[order[i]];
  }
  return result;
}

}  // namespace pss
