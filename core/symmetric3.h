#pragma once
// Eigenvectors of symmetric 3x3 matrices, with the same bits on every machine.

#include <array>

#include "core/lattice.h"

namespace pss {

/// A symmetric matrix by its upper triangle.
struct Symmetric3 {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
};

/// Eigenvalues in ascending order with their orthonormal eigenvectors, of either sign.
struct EigenSystem {
  std::array<double, 3> values;
  std::array<World3, 3> vectors;
};

/// Requires: finite elements.
/// Cost:     three to five sweeps of three plane rotations; allocates nothing.
/// Source:   cyclic Jacobi: Golub, Van Loan, "Matrix Computations", section 8.5.
EigenSystem eigen_decomposition(const Symmetric3& matrix);

}  // namespace pss
