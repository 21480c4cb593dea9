// pss info: what is in a file, a store, or a work directory.

#include <nlohmann/json.hpp>

#include "apps/command.h"
#include "apps/describe.h"
#include "apps/options.h"
#include "apps/standard_streams.h"
#include "io/open.h"

namespace pss {

namespace {

class Info : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positionals("PATH", "Files, stores (NAME.pss), work directories", paths_);
    arguments.flag("--json", "One JSON object a PATH instead of tables", json_);
    arguments.flag("--scan", "Read every point of a file: count them, measure their bounds", scan_);
    arguments.epilogue(
        "Examples:\n"
        "  pss info scan.las\n"
        "  pss info scan.ply --scan\n"
        "  pss info *.las --json | jq .points");
  }

  Result<void> run() override {
    for (const std::string& path : paths_) {
      PSS_ASSIGN(const nlohmann::ordered_json facts, describe(path));
      PSS_TRY(print_data(json_ ? dump(facts) : as_table(facts)));
    }
    return {};
  }

 private:
  Result<nlohmann::ordered_json> describe(const std::string& path) const {
    if (is_store(path)) {
      PSS_ASSIGN(const Store store, Store::open(path));
      return describe_store(store);
    }
    if (is_directory(path)) {
      PSS_ASSIGN(const JobState state, read_job_state(path));
      return describe_job(path, state);
    }
    PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_reader(path));
    return describe_file(*reader, scan_);
  }

  /// Bytes that are not UTF-8 become U+FFFD instead of a failure.
  static std::string dump(const nlohmann::ordered_json& facts) {
    return facts.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  }

  std::vector<std::string> paths_;
  bool json_ = false;
  bool scan_ = false;
};

}  // namespace

std::unique_ptr<Command> make_info() { return std::make_unique<Info>(); }

}  // namespace pss
