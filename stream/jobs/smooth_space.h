#pragma once
// How much disk a smoothing job takes: what is refused before it begins, and what --dry-run tells.

#include <cstddef>
#include <cstdint>

#include "core/lattice.h"
#include "stream/jobs/smooth.h"
#include "stream/operators/project.h"
#include "stream/passes/normals.h"
#include "stream/store/store.h"

namespace pss {

/// About how many bytes a job writes, and when it gives them back.
struct SmoothSpace {
  std::uint64_t sorted = 0;    ///< the sorted input, where the job makes it
  std::uint64_t normals = 0;   ///< of all points, where a first pass finds them
  std::uint64_t result = 0;    ///< a store
  std::uint64_t output = 0;    ///< not compressed; none where the output is the result
  bool keeps_sources = false;  ///< the first two stay while the output is written

  /// Of runs, stores and output together, at the worst moment.
  std::uint64_t most() const;
  /// What must be free once the input is sorted: for the stores, and for the output if it goes to
  /// the same disk.
  std::uint64_t most_more(bool with_output) const;
};

/// Points as a store keeps them.
struct StoredPoints {
  std::uint64_t points = 0;
  std::uint64_t bytes = 0;  ///< on disk
  Lattice lattice;
  std::size_t row_bytes = 0;
};

/// Of a job whose result has this lattice and these rows. New columns and the bits that refine
/// positions count in full: little of them compresses.
SmoothSpace smooth_space(const SmoothJob& job, NormalsFrom normals, const StoredPoints& source,
                         const Lattice& result_lattice, std::size_t result_row_bytes);
/// Of a job whose operator turns this store into its result.
SmoothSpace smooth_space(const SmoothJob& job, NormalsFrom normals, const Store& source,
                         const ProjectOperator& op);

}  // namespace pss
