// pss verify: every checksum and count of a store; the hash of its rows.

#include "stream/store/verify.h"

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/standard_streams.h"
#include "core/parallel.h"

namespace pss {

namespace {

class Verify : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positional("NAME.pss", "The store", store_);
    limits_.declare(arguments);
    reports_.declare_progress(arguments);
    arguments.epilogue(
        "Prints a table; the last line is the hash of the rows, which is equal for stores with\n"
        "equal points in equal order, however they are cut into tiles. Exit code 3 where\n"
        "something is damaged.\n\n"
        "Examples:\n"
        "  pss verify scan.pss");
  }

  Result<void> run() override {
    PSS_ASSIGN(const std::uint64_t limit, limits_.limit());
    ThreadLimit threads(limits_.threads);
    MemoryBudget budget(limit, thread_count());
    Progress progress(reports_.progress);
    PSS_ASSIGN(const VerifySummary summary, verify_store(store_, budget, progress));
    const Result<void> printed = print_data(table_of(summary));
    PSS_TRY(judge(summary, progress));
    return printed;
  }

 private:
  static std::string table_of(const VerifySummary& summary) {
    return fmt::format(
        "tiles    {}\nblocks   {}\npoints   {}\nbytes    {}\ncomplete {}\nrows     {}\n",
        summary.tiles, summary.blocks, summary.points, summary.bytes,
        summary.complete ? "yes" : "no", to_string(summary.rows));
  }

  Result<void> judge(const VerifySummary& summary, Progress& progress) const {
    for (const std::string& damage : summary.damage) progress.note(damage);
    if (!summary.sound())
      return Error{Fault::kBadInput,
                   fmt::format("{}: {} of its parts are damaged; make the store again from its "
                               "inputs",
                               store_, summary.damage_count)};
    if (!summary.complete)
      return Error{
          Fault::kBadInput,
          fmt::format("{}: sound but not complete; run the command that makes it again", store_)};
    return {};
  }

  std::string store_;
  LimitOptions limits_;
  ReportOptions reports_;
};

}  // namespace

std::unique_ptr<Command> make_verify() { return std::make_unique<Verify>(); }

}  // namespace pss
