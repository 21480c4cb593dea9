// pss convert: format to format, order and every attribute kept, streamed.

#include "io/convert.h"

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "io/formats/table.h"
#include "io/inputs.h"

namespace pss {

namespace {

class Convert : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positionals("INPUT", "Files, directories, globs, @list.txt", inputs_);
    arguments.option("-o,--output", "OUTPUT",
                     fmt::format("One file; its extension says the format: {} (required)",
                                 writable_extensions(", ")),
                     output_, parse_text);
    arguments.required();
    const std::string gridded = gridded_formats(", ");
    arguments.option("--scale", "S|X,Y,Z",
                     gridded + ": step of the written coordinates [the input's]", options_.scale,
                     parse_scale);
    arguments.option("--offset", "X,Y,Z",
                     gridded + ": origin of the written coordinates [the input's]", options_.offset,
                     parse_triple);
    declare_drop_outside(arguments, options_.drop_outside);
    declare_overwrite(arguments, options_.overwrite);
    reports_.declare_progress(arguments);
    arguments.epilogue(
        "Points keep their order; several inputs follow one another. LAS to LAS keeps every\n"
        "record, VLR and header field. Memory does not grow with the files.\n\n"
        "Examples:\n"
        "  pss convert scan.las -o scan.ply\n"
        "  pss convert tiles/*.las -o all.las\n"
        "  pss convert scan.ply -o scan.las --scale 0.001");
  }

  Result<void> run() override {
    PSS_ASSIGN(const std::vector<std::string> files, expand_inputs(inputs_, output_));
    Progress progress(reports_.progress);
    PSS_ASSIGN(const ConvertSummary summary, convert(files, output_, options_, progress));
    for (const std::string& note : summary.notes) progress.note(note);
    for (const auto& [reason, count] : summary.dropped)
      progress.note(fmt::format("dropped {} points: {}", grouped(count), reason));
    progress.note(fmt::format("{}: {} points in {}", output_, grouped(summary.points_out),
                              short_time(progress.seconds())));
    return {};
  }

 private:
  std::vector<std::string> inputs_;
  std::string output_;
  ConvertOptions options_;
  ReportOptions reports_;
};

}  // namespace

std::unique_ptr<Command> make_convert() { return std::make_unique<Convert>(); }

}  // namespace pss
