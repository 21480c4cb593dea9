#pragma once
// What a kind of job (smooth, tile, ...) adds to what every job does: its words and its passes.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/lattice.h"
#include "core/result.h"
#include "io/points/schema.h"
#include "stream/jobs/job_report.h"
#include "stream/jobs/pass_context.h"
#include "stream/passes/operator.h"
#include "stream/store/store.h"

namespace pss {

/// As far as a store's size follows from it.
struct StoreShape {
  Lattice lattice;
  std::size_t row_bytes = 0;
  bool columns_alone = false;  ///< without positions, to be joined to its source
};
StoreShape shape_of(const StoreHeader& header);
StoreShape shape_of(const Operator& op);

/// An operator over points: its result is the store NAME.pss in the work directory.
struct Pass {
  std::string name;  ///< of a to z, 0 to 9 and '-', but "input", "replaced"; no other pass has it
  std::unique_ptr<const PassSource> queries;
  std::unique_ptr<const PassSource> neighbours = {};  ///< none: the queries'
  /// Its result's header has parameters that owned_by() has marked with the job's identity.
  std::unique_ptr<const Operator> op;
  double largest_move = 0;  ///< no pass of the job moves a point farther
  /// What the passes after it will store, as far as that is known: their room is made sure of.
  std::vector<StoreShape> later = {};

  const Source& source() const { return queries->points(); }
  PassSources sources() const { return {source(), neighbours ? neighbours->points() : source()}; }
};

/// The passes that a job may need, in their order; the last of them is always made.
struct PassNames {
  std::vector<std::string> names;  ///< the first of them at least, unless there is none at all
  bool may_grow = false;  ///< more may turn out to be needed, such as rounds until all is settled
};

/// Which of its words the sorted input of a kind of job depends on, beyond those of all jobs.
struct SortingChoice {
  std::optional<World3> lattice_step;
  bool has_lattice_step = false;  ///< the kind has such a word, given or not
};

/// A kind of job. One object describes one job, and learns while that runs what it will report.
///
/// Thread: one.
class JobKind {
 public:
  virtual ~JobKind() = default;

  /// The word of the command line, which is part of the job's identity.
  virtual std::string_view command() const = 0;
  /// What the result depends on beside the sorted input: an object, by the names of the flags.
  virtual nlohmann::json parameters() const = 0;
  virtual SortingChoice sorting() const { return {}; }
  virtual PassNames passes() const = 0;

  /// Refuses words that contradict each other, before anything is made. Errors: kUsage.
  virtual Result<void> check() const = 0;
  /// Refuses a source of this schema, before anything is sorted. Errors: kUsage.
  virtual Result<void> check_source(const Schema& /*source*/) const { return {}; }
  /// The attributes that the result has, of a source with these.
  virtual Result<Schema> result_schema(const Schema& source) const { return source; }
  /// What next() takes of the memory limit at once, beside tables and headers.
  virtual std::uint64_t measuring_memory() const { return 0; }

  /// The next pass, given what `job.done` has noted; empty: all is done, and the last pass's store
  /// is the result, or the sorted input where there was none. May measure.
  ///
  /// Holds no store of whole points open but what it returns, and one operator at a time: each has
  /// a header, whose memory is counted (kHeaderCopies).
  virtual Result<std::optional<Pass>> next(PassContext& job) = 0;

  /// Adds to `summary`, which the result's store keeps, what the report will need of all before the
  /// writing: a later run may find nothing but the result. No times: they are no part of a result.
  virtual void remember(nlohmann::ordered_json& /*summary*/) const {}
  /// Takes it back. Errors: throws nlohmann::json::exception for values of other types.
  virtual void recall(const nlohmann::ordered_json& /*summary*/) {}
  /// Takes in what the result notes, and says in `report.notes` what should be known.
  ///
  /// Errors: kBadInput where another version of pss wrote its note.
  virtual Result<void> look_at(const Store& /*result*/, JobReport& /*report*/) { return {}; }

  // For --dry-run.

  /// What each pass will store of a source that is not sorted yet, about.
  virtual std::vector<StoreShape> expect(const StoreHeader& /*source*/) { return {}; }
  /// Of one thread, over all passes, as far as widths are known by next() or expect().
  virtual double seconds_per_point() const { return 0; }
};

/// Parameters as a result's header has them: with the identity of the job whose result it is.
std::string owned_by(const std::string& identity, nlohmann::ordered_json parameters);
/// The identity in a result's header; empty where there is none.
std::string owner_in(const std::string& parameters);

}  // namespace pss
