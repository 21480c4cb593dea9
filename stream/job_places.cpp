// What is refused of a job's places, and what their names take, before the job begins.

#include <fmt/format.h>

#include "io/file.h"
#include "stream/job.h"
#include "stream/manifest.h"

namespace pss {
namespace {

/// Of an input, as a name, a fingerprint, what is kept of its header, and JSON; and of its path, so
/// many copies. Measured: 2.4 KB for a path of 110 bytes.
constexpr std::uint64_t kInputBytes = 1600;
constexpr std::uint64_t kPathCopies = 8;

/// A work directory within a store, or within what is to become the output, would be part of it.
Result<void> check_outside(const std::string& work_dir, const std::string& place) {
  if (!lies_in(work_dir, place)) return {};
  return Error{Fault::kUsage,
               fmt::format("--work-dir {}: lies in {}; use one outside", work_dir, place)};
}

}  // namespace

Result<void> check_places(const JobPlaces& places) {
  const std::string work_dir = places.work_directory();
  for (const std::string& input : places.inputs) {
    if (lies_in(input, work_dir))
      return Error{Fault::kUsage, fmt::format("{}: lies in the work directory {}; use another "
                                              "--work-dir",
                                              input, work_dir)};
    if (is_directory(places.output) && lies_in(input, places.output))
      return Error{Fault::kUsage,
                   fmt::format("{}: lies in {}, which is to be replaced; choose another output",
                               input, places.output)};
  }
  if (lies_in(places.output, work_dir))
    return Error{Fault::kUsage,
                 fmt::format("{}: the output lies in the work directory {}; use another --work-dir",
                             places.output, work_dir)};
  PSS_TRY(check_outside(work_dir, places.output));
  for (const std::string& input : places.inputs) PSS_TRY(check_outside(work_dir, input));
  if (has_manifest(directory_of(real_path_of(work_dir))))
    return Error{Fault::kUsage,
                 fmt::format("--work-dir {}: lies in a store; use one outside", work_dir)};
  PSS_TRY(check_work_directory(work_dir));
  if (is_store_name(places.output) && !same_disk(work_dir, directory_of(places.output)))
    return Error{
        Fault::kUsage,
        fmt::format("--work-dir {}: lies on another disk than {}, which a store is renamed "
                    "to; use one on the same disk",
                    work_dir, places.output)};
  return {};
}

Result<Reservation> reserve_names(const std::vector<std::string>& inputs, MemoryBudget& budget) {
  std::uint64_t bytes = 0;
  for (const std::string& input : inputs) bytes += kInputBytes + kPathCopies * input.size();
  if (auto reservation = budget.reserve(bytes)) return *std::move(reservation);
  return Error{Fault::kMemoryLimit,
               fmt::format("the names of {} inputs take {} MiB, {} are left of the memory limit; "
                           "use --memory-limit {}M or more",
                           inputs.size(), (bytes >> 20) + 1, budget.available() >> 20,
                           ((budget.limit() + bytes - budget.available()) >> 20) + 1)};
}

}  // namespace pss
