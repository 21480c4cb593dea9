// check_places() of stream/jobs/job_request.h: what is refused of a job's places before it begins.

#include <fmt/format.h>

#include "io/file/file.h"
#include "stream/jobs/job_request.h"
#include "stream/jobs/work_directory.h"
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

Result<void> check_places(const JobRequest& request) {
  const std::string work_dir = request.work_directory();
  for (const std::string& input : request.inputs) {
    if (lies_in(input, work_dir))
      return Error{Fault::kUsage, fmt::format("{}: lies in the work directory {}; use another "
                                              "--work-dir",
                                              input, work_dir)};
    if (is_directory(request.output) && lies_in(input, request.output))
      return Error{Fault::kUsage,
                   fmt::format("{}: lies in {}, which is to be replaced; choose another output",
                               input, request.output)};
  }
  if (lies_in(request.output, work_dir))
    return Error{Fault::kUsage,
                 fmt::format("{}: the output lies in the work directory {}; use another --work-dir",
                             request.output, work_dir)};
  PSS_TRY(check_outside(work_dir, request.output));
  for (const std::string& input : request.inputs) PSS_TRY(check_outside(work_dir, input));
  if (has_manifest(directory_of(real_path_of(work_dir))))
    return Error{Fault::kUsage,
                 fmt::format("--work-dir {}: lies in a store; use one outside", work_dir)};
  PSS_TRY(check_work_directory(work_dir));
  if (is_store_name(request.output) && !same_disk(work_dir, directory_of(request.output)))
    return Error{
        Fault::kUsage,
        fmt::format("--work-dir {}: lies on another disk than {}, which a store is renamed "
                    "to; use one on the same disk",
                    work_dir, request.output)};
  return {};
}

}  // namespace pss
