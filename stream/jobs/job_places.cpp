// check_places() of stream/jobs/job.h: what is refused of a job's places before it begins.

#include <fmt/format.h>

#include "io/file/file.h"
#include "stream/jobs/job.h"
#include "stream/store/manifest.h"

namespace pss {
namespace {

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

}  // namespace pss
