#pragma once
// A bound on what may be allocated while something runs; beyond it the program ends.

#include <cstddef>

namespace pss::test {

/// While this lives, everything that operator new has given out stays below `bytes`; one at a time.
class AllocationBound {
 public:
  explicit AllocationBound(std::size_t bytes);
  ~AllocationBound();
  AllocationBound(const AllocationBound&) = delete;
  AllocationBound& operator=(const AllocationBound&) = delete;
};

}  // namespace pss::test
