#pragma once
// The vector targets that the kernels are compiled for, to try each of them.

#include <cstdint>
#include <string>
#include <vector>

namespace pss::simd {

struct Target {
  std::string name;  ///< "AVX3", "AVX2", "SCALAR", ...
  std::int64_t bit;
};

/// Those that this machine runs, the widest first.
std::vector<Target> targets();

/// Makes the kernels run in one target while it lives.
///
/// Thread: while no other thread projects.
class ForcedTarget {
 public:
  explicit ForcedTarget(const Target& target);
  ~ForcedTarget();
  ForcedTarget(const ForcedTarget&) = delete;
  ForcedTarget& operator=(const ForcedTarget&) = delete;
};

}  // namespace pss::simd
