#pragma once
// The reference plane of a point: where on its normal line the foot point lies, and which way.

#include "core/status.h"
#include "core/weighted_block.h"

namespace pss {

/// The plane through q = t n with unit normal n, in units of h relative to the query.
struct ReferencePlane {
  Status status = Status::kTooFew;  ///< kOk, kTooFew, kDegenerate or kOutOfDomain
  World3 normal{0, 0, 0};           ///< canonical sign; zero where there is none
  double t = 0;                     ///< in (-1/2, 1/2) where the status is kOk
  int passes = 0;                   ///< over the neighbours, after the first
};

/// The reference plane as docs/algorithm.md defines it: start, safeguards and choice of minimum.
///
/// Errors:   none; a status.
/// Cost:     usually four passes over the neighbours, at most 65; allocates nothing.
/// Source:   Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva, "Computing and Rendering Point Set
///           Surfaces", TVCG 9(1), 2003; conditions as in Amenta, Kil, "Defining Point-Set
///           Surfaces", 2004.
ReferencePlane find_reference_plane(const Neighbourhood& near);

/// The plane of the operator `fast`: the weighted plane through the weighted centroid, weights
/// about the foot point, until it no longer moves.
///
/// Errors:   none; a status.
/// Cost:     usually three passes over the neighbours, at most 65; allocates nothing.
ReferencePlane find_settled_plane(const Neighbourhood& near);

}  // namespace pss
