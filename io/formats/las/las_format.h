#pragma once
// The row of LAS in the table of formats.

#include "io/points/format.h"

namespace pss {

extern const Format kLasFormat;

}  // namespace pss
