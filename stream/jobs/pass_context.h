#pragma once
// What of a running job decides about its next pass: its sorted input, and what its passes made.

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/monitor.h"
#include "core/result.h"
#include "io/file/fingerprint.h"
#include "stream/jobs/job_report.h"
#include "stream/jobs/job_request.h"
#include "stream/limit/memory.h"
#include "stream/passes/source.h"
#include "stream/store/note.h"
#include "stream/store/store.h"

namespace pss {

class JobKind;

/// Points that a pass reads: a store, the columns that are joined to it, the memory of their
/// tables.
class PassSource {
 public:
  PassSource(Store store, Reservation tables)
      : store_{std::move(store), std::move(tables)}, points_(store_.store) {}
  PassSource(const PassSource&) = delete;
  PassSource& operator=(const PassSource&) = delete;

  const Store& store() const { return store_.store; }
  const Source& points() const { return points_; }
  /// Adds columns that an earlier pass made of this store. Errors: those of Source::join().
  Result<void> join(Store columns, Reservation tables);

 private:
  struct Open {
    Store store;
    Reservation tables;
  };
  Open store_;
  std::vector<std::unique_ptr<const Open>> columns_;
  Source points_;  ///< views the stores
};

/// A pass that is complete.
struct DonePass {
  std::string name;
  std::uint64_t points = 0;  ///< of its result
  Note note;                 ///< its tiles' notes, merged by the operator in row order
};

/// The job as JobKind::next() sees it.
struct PassContext {
  const JobRequest& request;
  const JobKind& kind;
  std::string work_dir;             ///< empty in a dry run, which has no results
  std::vector<InputRecord> inputs;  ///< as the job found them; empty in a dry run
  std::string identity;             ///< of the job, for owned_by()
  MemoryBudget& budget;
  Monitor& monitor;
  JobReport& report;  ///< gets stages by StageTimer, and notes
  std::vector<DonePass> done = {};

  /// The points of the inputs in order: the store that was given, or that the job has sorted.
  ///
  /// Errors: those of Store::open(); where a given store is not complete or has changed; where the
  ///         result could not hold its attributes or its box; kMemoryLimit for its tables.
  Result<std::unique_ptr<PassSource>> open_input() const;
  /// What a pass of this job, which is done, made of it.
  Result<std::unique_ptr<PassSource>> open_result(std::string_view pass) const;
  /// Joins to `source` the columns that such a pass made of it.
  Result<void> join(PassSource& source, std::string_view pass) const;
};

}  // namespace pss
