#include "core/spacing.h"

#include <cmath>
#include <numbers>

namespace pss {

double spacing_of_d16(double d16) { return d16 * std::sqrt(std::numbers::pi / kSpacingRank); }

}  // namespace pss
