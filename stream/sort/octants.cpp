#include "stream/sort/octants.h"

#include <algorithm>

namespace pss {

int leaf_level(const Key& first, const Key* before, const Key* beyond) {
  int shared = -1;
  if (before) shared = std::max(shared, common_level(first, *before));
  if (beyond) shared = std::max(shared, common_level(first, *beyond));
  return std::min(shared + 1, kLatticeBits);
}

}  // namespace pss
