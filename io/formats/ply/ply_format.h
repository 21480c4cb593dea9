#pragma once
// The row of PLY in the table of formats.

#include "io/points/format.h"

namespace pss {

extern const Format kPlyFormat;

}  // namespace pss
