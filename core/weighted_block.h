#pragma once
// The inner loops' view of a neighbourhood: blocks of local coordinates and weights on the stack.

#include <algorithm>
#include <cstddef>
#include <variant>

#include "core/neighbours.h"
#include "core/vec3.h"
#include "core/weight.h"

namespace pss {

/// The neighbours of a query in units of h; the query is the origin.
struct Neighbourhood {
  const Offsets& offsets;
  double per_h;  ///< 1 / h
  AnyWeight weight;
};

/// Some consecutive neighbours seen from a foot point: in-plane coordinates, heights, weights.
struct WeightedBlock {
  static constexpr std::size_t kSize = 64;

  std::size_t count;
  alignas(16) double x[kSize], y[kSize], d[kSize], weight[kSize];
};

/// The same, with the weights' derivatives with respect to the squared distance.
struct DerivativeBlock : WeightedBlock {
  alignas(16) double first[kSize], second[kSize];
};

/// A coordinate in units of h, kept finite where the weight is zero anyway; NaN ends there too.
inline double within_reach(double coordinate) {
  constexpr double kBeyond = TaperedGaussian::kWidest + 8;
  const double upper = coordinate < kBeyond ? coordinate : kBeyond;
  return upper > -kBeyond ? upper : -kBeyond;
}

template <class Weight>
void weigh(const Weight& weight, double rho_sq, std::size_t i, WeightedBlock& b) {
  b.weight[i] = weight.weight(rho_sq);
}

template <class Weight>
void weigh(const Weight& weight, double rho_sq, std::size_t i, DerivativeBlock& b) {
  const WeightValue value = weight.with_derivatives(rho_sq);
  b.weight[i] = value.weight;
  b.first[i] = value.first;
  b.second[i] = value.second;
}

/// Calls use(block) for all neighbours in order, seen from the point t n of `frame`.
///
/// The loop inside has no branch and no sum: it vectorises, and no sum's order changes.
template <class Block, class Weight, class Use>
void for_each_block(const Neighbourhood& near, const Weight& weight_at, const Frame& frame,
                    double t, Use use) {
  Block block;
  const Frame f = frame;
  const Weight weight = weight_at;
  const double per_h = near.per_h;
  for (std::size_t begin = 0; begin < near.offsets.size(); begin += Block::kSize) {
    const std::size_t count = std::min(Block::kSize, near.offsets.size() - begin);
    const double* const px = near.offsets.x.data() + begin;
    const double* const py = near.offsets.y.data() + begin;
    const double* const pz = near.offsets.z.data() + begin;
    for (std::size_t i = 0; i < count; ++i) {
      const double a = within_reach(px[i] * per_h);
      const double b = within_reach(py[i] * per_h);
      const double c = within_reach(pz[i] * per_h);
      const double x = f.u[0] * a + f.u[1] * b + f.u[2] * c;
      const double y = f.v[0] * a + f.v[1] * b + f.v[2] * c;
      const double d = f.n[0] * a + f.n[1] * b + f.n[2] * c - t;
      block.x[i] = x;
      block.y[i] = y;
      block.d[i] = d;
      weigh(weight, x * x + y * y + d * d, i, block);
    }
    block.count = count;
    use(static_cast<const Block&>(block));
  }
}

/// The same with the neighbourhood's own weight.
template <class Block, class Use>
void for_each_block(const Neighbourhood& near, const Frame& frame, double t, Use use) {
  std::visit([&](const auto& weight) { for_each_block<Block>(near, weight, frame, t, use); },
             near.weight);
}

}  // namespace pss
