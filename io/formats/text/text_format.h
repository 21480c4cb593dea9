#pragma once
// The row of text in the table of formats.

#include "io/points/format.h"

namespace pss {

extern const Format kTextFormat;

}  // namespace pss
