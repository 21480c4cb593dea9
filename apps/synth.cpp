// pss synth: noisy scans of known surfaces, and how far a file is from one.

#include <fmt/format.h>

#include "apps/command.h"
#include "apps/options.h"
#include "apps/progress.h"
#include "apps/standard_streams.h"
#include "core/parallel.h"
#include "io/convert.h"
#include "io/synth/measure.h"
#include "io/synth/synth.h"
#include "io/watched_reader.h"

namespace pss {
namespace {

constexpr const char* kEpilogue =
    "SHAPE is torus (--size MAJOR,MINOR radius), sphere (RADIUS), plane (WIDTH,DEPTH,SLOPE_X,\n"
    "SLOPE_Y) or terrain (WIDTH,DEPTH). The spacing is the root of area / points, over all scans.\n"
    "The same options give the same bytes on every machine and number of threads. The true\n"
    "surface's parameters are printed to stdout as JSON.\n"
    "With --measure nothing is written: repeat the options that made the scan, and the distances\n"
    "of FILE to the true surface are printed, with the errors of its normals and curvatures.\n\n"
    "Examples:\n"
    "  pss synth torus -o torus.las --points 2M --scans 3 --noise 0.3\n"
    "  pss synth torus --points 2M --scans 3 --noise 0.3 --measure smooth.las\n"
    "  pss synth terrain -o hills.ply --points 1e7 --offset 500000,4649776,100 --truth";

/// Numbers between commas.
Result<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  while (true) {
    const std::size_t comma = text.find(',');
    PSS_ASSIGN(const double number, parse_number(text.substr(0, comma)));
    numbers.push_back(number);
    if (comma == std::string_view::npos) return numbers;
    text.remove_prefix(comma + 1);
  }
}

class Synth : public Command {
 public:
  void declare(Arguments& arguments) override {
    arguments.positional("SHAPE", "torus, sphere, plane or terrain", shape_);
    arguments.option("-o,--output", "OUTPUT", "A file; the extension says the format", output_,
                     parse_text);
    arguments.option("--measure", "FILE", "Measure FILE against the surface instead of writing",
                     measured_, parse_text);
    arguments.flag("--json", "With --measure: JSON instead of a table", json_);
    declare_scan(arguments);
    declare_overwrite(arguments, overwrite_);
    arguments.option("--threads", "N", "Threads to use [all]", threads_, parse_threads);
    reports_.declare_progress(arguments);
    arguments.epilogue(kEpilogue);
  }

  Result<void> run() override {
    PSS_ASSIGN(options_.surface, make_surface(shape_, sizes_));
    options_.time = !no_time_;
    options_.order = order_ == "sweep" ? SynthOrder::kSweep : SynthOrder::kScattered;
    PSS_TRY(check(options_));
    if (output_.empty() == measured_.empty())
      return Error{Fault::kUsage, "synth needs either -o OUTPUT or --measure FILE"};
    if (json_ && measured_.empty())
      return Error{Fault::kUsage, "--json has no meaning without --measure; leave it out"};
    ThreadLimit threads(threads_);
    Progress progress(reports_.progress);
    return output_.empty() ? measure_file(progress) : write_scan(progress);
  }

 private:
  void declare_scan(Arguments& arguments) {
    arguments.option("--size", "A,B,...", "Sizes of the shape [1,0.4; 1; 100,100; 1000,1000]",
                     sizes_, parse_numbers);
    arguments.option("--points", "N", "Points of all scans together: 2M, 1e9 [1M]", options_.points,
                     parse_count);
    arguments.option("--noise", "S", "Standard deviation along the normal, in spacings [0]",
                     options_.noise, parse_number);
    arguments.option("--scans", "K", "Overlapping scans, each of 3/4 of the surface [1: all of it]",
                     options_.scans, parse_integer);
    arguments.option("--jitter", "J",
                     "How far samples may be off an even lattice, in spacings [0.25]",
                     options_.jitter, parse_number);
    arguments.option("--corner-density", "F", "Times denser a sixteenth of the surface is [1]",
                     options_.corner_density, parse_number);
    arguments.option("--density-gradient", "F",
                     "The densest place over the sparsest, changing smoothly [1]",
                     options_.density_gradient, parse_number);
    arguments.option("--offset", "X,Y,Z", "Added to all coordinates [0,0,0]", options_.offset,
                     parse_triple);
    arguments.option("--scale", "S", "Step of the coordinates [power of ten below spacing/1000]",
                     options_.scale, parse_positive);
    arguments.option("--seed", "N", "Of noise and place [1]", options_.seed, parse_count);
    arguments.choice("--order", {"scattered", "sweep"},
                     "Consecutive records lie far apart, or along a moving front [scattered]",
                     order_);
    arguments.flag("--no-time", "Leave GpsTime out: LAS records of 20 bytes", no_time_);
    arguments.flag("--truth", "Add TrueX, TrueY, TrueZ and TrueDistance to every point",
                   options_.truth);
  }

  Result<void> write_scan(Progress& progress) const {
    PSS_ASSIGN(const std::unique_ptr<Reader> reader, SynthReader::create(options_));
    Reader* const scan = reader.get();
    ConvertOptions options;
    options.overwrite = overwrite_;
    PSS_ASSIGN(const ConvertSummary summary, copy_points({&scan, 1}, output_, options, progress));
    for (const std::string& note : summary.notes) progress.note(note);
    return print_data(parameters_json(options_) + "\n");
  }

  Result<void> measure_file(Progress& progress) const {
    PSS_ASSIGN(const InputRecord record, settled_fingerprint(measured_));
    PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_watched(record, HeadBytes::kLeft));
    PSS_ASSIGN(const Measurement measurement, measure(*reader, options_, progress));
    return print_data(json_ ? measurement_json(measurement, options_) + "\n"
                            : measurement_table(measurement, options_));
  }

  std::string shape_, output_, measured_;
  std::vector<double> sizes_;
  std::string order_ = "scattered";
  SynthOptions options_;
  bool no_time_ = false;
  bool json_ = false;
  bool overwrite_ = false;
  int threads_ = 0;
  ReportOptions reports_;
};

}  // namespace

std::unique_ptr<Command> make_synth() { return std::make_unique<Synth>(); }

}  // namespace pss
