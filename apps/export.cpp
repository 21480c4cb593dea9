// pss export: a store written as one file.

#include "stream/store/export.h"

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "core/parallel.h"
#include "io/file/fingerprint.h"
#include "io/inputs.h"
#include "stream/store/input_memory.h"
#include "stream/store/store.h"

namespace pss {

namespace {

class Export : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positional("NAME.pss", "The store", store_);
    arguments.option("-o,--output", "OUTPUT", "The file; its extension says the format (required)",
                     output_, parse_text);
    arguments.required();
    declare_overwrite(arguments, overwrite_);
    grid_.declare(arguments);
    limits_.declare(arguments);
    reports_.declare_progress(arguments);
    arguments.epilogue(
        "Rows are written in the store's order.\n\n"
        "Examples:\n"
        "  pss export scan.pss -o scan.las\n"
        "  pss export scan.pss -o scan.ply --memory-limit 256M");
  }

  Result<void> run() override {
    PSS_ASSIGN(const std::uint64_t limit, limits_.limit());
    PSS_TRY(check_output({&store_, 1}, output_));
    ThreadLimit threads(limits_.threads);
    MemoryBudget budget(limit, thread_count());
    Progress progress(reports_.progress);
    const auto manifest = fingerprint(manifest_path(store_));
    PSS_ASSIGN(const Reservation header, reserve_header_and_head(store_, budget));
    PSS_ASSIGN(const Store store, Store::open(store_));
    // The header that was reserved must be that of the store that is read.
    if (manifest) PSS_TRY(check_unchanged(*manifest));
    const ExportOptions options{.scale = grid_.scale.steps,
                                .scale_auto = grid_.scale.automatic,
                                .offset = grid_.offset,
                                .rules = {.overwrite = overwrite_}};
    PSS_ASSIGN(const ExportSummary summary,
               export_store(store, output_, options, budget, progress));
    for (const std::string& note : summary.notes) progress.note(note);
    progress.note(fmt::format("{}: {} points in {}", output_, grouped(summary.points),
                              short_time(progress.seconds())));
    return {};
  }

 private:
  std::string store_;
  std::string output_;
  bool overwrite_ = false;
  GridOptions grid_;
  LimitOptions limits_;
  ReportOptions reports_;
};

}  // namespace

std::unique_ptr<Command> make_export() { return std::make_unique<Export>(); }

}  // namespace pss
