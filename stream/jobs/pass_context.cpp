#include "stream/jobs/pass_context.h"

#include <fmt/format.h>

#include <utility>

#include "stream/jobs/attributes.h"
#include "stream/jobs/work_directory.h"

namespace pss {
namespace {

/// A store that the user gave is another process's to change.
Result<void> check_given(const PassContext& job, const Store& store) {
  PSS_TRY(check_unchanged(job.inputs));
  if (!store.complete())
    return Error{Fault::kBadInput,
                 fmt::format("{}: the store is not complete; run the command that makes it again",
                             store.path())};
  return check_attributes(job.request, job.kind, store.header());
}

/// The memory of a store's table.
Result<Reservation> tables_of(const Store& store, MemoryBudget& budget) {
  return budget.take(store.table_memory(),
                     fmt::format("the table of {} tiles", store.tiles().size()));
}

Result<std::unique_ptr<PassSource>> with_tables(Store store, MemoryBudget& budget) {
  PSS_ASSIGN(Reservation tables, tables_of(store, budget));
  return std::make_unique<PassSource>(std::move(store), std::move(tables));
}

}  // namespace

Result<void> PassSource::join(Store columns, Reservation tables) {
  columns_.push_back(std::make_unique<Open>(std::move(columns), std::move(tables)));
  return points_.join(columns_.back()->store);
}

Result<std::unique_ptr<PassSource>> PassContext::open_input() const {
  const bool given = is_store_input(request);
  PSS_ASSIGN(Store store, Store::open(given ? request.inputs.front() : input_store_in(work_dir)));
  if (given) PSS_TRY(check_given(*this, store));
  if (given) report.ingest.points_read = report.ingest.points_stored = store.points();
  report.store_bytes = store.bytes_on_disk();
  PSS_TRY(check_output_box(store, request));
  return with_tables(std::move(store), budget);
}

Result<std::unique_ptr<PassSource>> PassContext::open_result(std::string_view pass) const {
  PSS_ASSIGN(Store store, Store::open(pass_store_in(work_dir, pass)));
  return with_tables(std::move(store), budget);
}

Result<void> PassContext::join(PassSource& source, std::string_view pass) const {
  PSS_ASSIGN(Store columns, Store::open(pass_store_in(work_dir, pass)));
  PSS_ASSIGN(Reservation tables, tables_of(columns, budget));
  return source.join(std::move(columns), std::move(tables));
}

}  // namespace pss
