#pragma once
// What a program says of the MLS surface that it wants, and the widths that follow from it.

#include <optional>

#include "core/lattice.h"
#include "core/method.h"
#include "core/projection.h"
#include "core/result.h"
#include "core/sorted_cloud.h"

namespace pss {

/// Which surface, and how wide it looks; lengths in the units of the points.
///
/// With neither h nor radius nor knn, h is twice the measured spacing. That suits little noise: for
/// noise of 0.1 to 0.3 spacings choose an h of 4 to 6 spacings. `method.degree` has no meaning for
/// apss and rimls.
struct MlsOptions {
  Method method;
  double h = 0;       ///< width of the weight; 0: from `radius`
  double radius = 0;  ///< where the weight ends, at least h; 0: 3 h, and 4 h for degree 4, h for
                      ///< the weight of PCL
  int knn = 0;        ///< each query's radius is the distance to this neighbour, at most `radius`
                      ///< (0: 10 spacings); h is not given then
  std::optional<Lattice> lattice;  ///< that the points stand on; by default a fine one around them
};

/// How wide queries look: all the same, or each to its k-th neighbour.
struct MlsWidths {
  Support support;  ///< of all queries; zeros where each has its own, or none has any
  int nearest = 0;  ///< the neighbour whose distance is a query's radius; 0: `support` counts
  double cap = 0;   ///< of that distance
};

/// Errors: kUsage for options that make no sense.
Result<void> check_options(const MlsOptions& options);

/// All zeros where a spacing is needed and the cloud has none.
///
/// Requires: checked options.
MlsWidths choose_widths(const MlsOptions& options, const SortedCloud& cloud);

/// How far from the query the widest of all looks.
double widest_reach(const MlsWidths& widths, const Method& method);

}  // namespace pss
