#include "stream/jobs/smooth_space.h"

#include <algorithm>
#include <cmath>

#include "io/formats/table.h"
#include "stream/jobs/smooth_job.h"

namespace pss {
namespace {

/// Of the lowest bits that a finer step adds to a position.
double refining_bytes(const Lattice& coarse, const Lattice& fine) {
  double bits = 0;
  for (std::size_t a = 0; a < 3; ++a) bits += std::log2(coarse.scale[a] / fine.scale[a]);
  return bits / 8;
}

/// The most that a point takes in a file.
std::uint64_t output_bytes(const std::string& path, std::size_t row_bytes) {
  const Format* format = format_by_extension(path);
  return (format ? format->bytes_factor : 1) * (3 * sizeof(std::int32_t) + row_bytes);
}

}  // namespace

std::uint64_t SmoothSpace::most() const { return sorted + std::max(sorted, most_more(true)); }

std::uint64_t SmoothSpace::most_more(bool with_output) const {
  const std::uint64_t computing = normals + result;
  if (!with_output) return computing;
  if (keeps_sources) return computing + output;
  return std::max(computing, result + output - std::min(result + output, sorted));
}

SmoothSpace smooth_space(const SmoothJob& job, NormalsFrom normals, const StoredPoints& source,
                         const Lattice& result_lattice, std::size_t result_row_bytes) {
  const auto points = static_cast<double>(source.points);
  const auto bytes = [&](double more_a_point) {
    return source.bytes + static_cast<std::uint64_t>(std::max(0.0, more_a_point) * points);
  };
  SmoothSpace space;
  if (!is_store_input(job)) space.sorted = source.bytes;
  if (normals == NormalsFrom::kFirstPass) space.normals = source.points * sizeof(Normal);
  space.result =
      bytes(refining_bytes(source.lattice, result_lattice) + static_cast<double>(result_row_bytes) -
            static_cast<double>(source.row_bytes));
  if (!is_store_name(job.output))
    space.output = source.points * output_bytes(job.output, result_row_bytes);
  space.keeps_sources = job.options.keep_work;
  return space;
}

SmoothSpace smooth_space(const SmoothJob& job, NormalsFrom normals, const Store& source,
                         const ProjectOperator& op) {
  const StoreHeader& from = source.header();
  const StoreHeader& to = op.result_header();
  return smooth_space(
      job, normals, {source.points(), source.bytes_on_disk(), from.lattice, from.schema.row_size()},
      to.lattice, to.schema.row_size());
}

}  // namespace pss
