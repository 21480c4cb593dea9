#include "stream/jobs/job_space.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "io/file/file.h"
#include "io/formats/table.h"

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

Result<void> check_free(const std::string& folder, std::uint64_t present, std::uint64_t needed,
                        const char* what) {
  PSS_ASSIGN(const std::uint64_t free, free_space(folder));
  if (free + present >= needed) return {};
  return Error{Fault::kFailed, fmt::format("{}: {} MiB free, about {} MiB needed {}, or make room",
                                           folder, free >> 20, needed >> 20, what)};
}

std::uint64_t store_bytes(const StoredPoints& source, const StoreShape& result) {
  if (result.columns_alone) return source.points * result.row_bytes;
  const double more_a_point = refining_bytes(source.shape.lattice, result.lattice) +
                              static_cast<double>(result.row_bytes) -
                              static_cast<double>(source.shape.row_bytes);
  const double more = std::max(0.0, more_a_point) * static_cast<double>(source.points);
  return source.bytes + static_cast<std::uint64_t>(more);
}

}  // namespace

std::uint64_t JobSpace::most() const { return sorted + std::max(sorted, most_more(true)); }

std::uint64_t JobSpace::most_more(bool with_output) const {
  const std::uint64_t computing = std::reduce(passes.begin(), passes.end(), std::uint64_t{0});
  if (!with_output) return computing;
  if (keeps_sources) return computing + output;
  const std::uint64_t writing = (passes.empty() ? 0 : passes.back()) + output;
  return std::max(computing, writing - std::min(writing, sorted));
}

StoredPoints stored_points(const Store& store) {
  return {store.points(), store.bytes_on_disk(), shape_of(store.header())};
}

JobSpace job_space(const JobRequest& request, const StoredPoints& source,
                   std::span<const StoreShape> passes) {
  JobSpace space;
  if (!is_store_input(request)) space.sorted = source.bytes;
  for (const StoreShape& shape : passes) space.passes.push_back(store_bytes(source, shape));
  const StoreShape& result = passes.empty() ? source.shape : passes.back();
  if (!is_store_name(request.output))
    space.output = source.points * output_bytes(request.output, result.row_bytes);
  space.keeps_sources = request.keep_work;
  return space;
}

Result<void> check_space(const JobRequest& request, const JobSpace& space, std::uint64_t present) {
  const std::string work_dir = request.work_directory();
  const std::string folder = directory_of(request.output);
  const bool apart = !same_disk(work_dir, folder);
  if (apart)
    PSS_TRY(check_free(folder, 0, space.output, "for the output; write it to another disk"));
  return check_free(work_dir, present, space.most_more(!apart),
                    apart ? "for the result; use --work-dir on another disk"
                          : "for the result and the output; use --work-dir on another disk");
}

}  // namespace pss
