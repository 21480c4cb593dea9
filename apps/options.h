#pragma once
// What the values of options mean, and the options that several subcommands share.

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/arguments.h"
#include "core/lattice.h"
#include "core/result.h"
#include "stream/jobs/job_request.h"

namespace pss {

/// The text itself.
Result<std::string> parse_text(std::string_view text);
/// The name of an output: the text without '/' at its end.
Result<std::string> parse_output(std::string_view text);
/// A finite number: "0.5", "1e-3".
Result<double> parse_number(std::string_view text);
/// A number above zero.
Result<double> parse_positive(std::string_view text);
/// A whole number that is not negative: "4".
Result<int> parse_integer(std::string_view text);
/// How many threads: "4"; 0 for all, and no more than a few for each that the machine runs.
Result<int> parse_threads(std::string_view text);
/// How many: "1000", "10k", "2M", "1e9"; k, M, G, T are powers of 1000.
Result<std::uint64_t> parse_count(std::string_view text);
/// How many points a tile owns at most: a count from 1 to 2^30.
Result<std::uint32_t> parse_tile_points(std::string_view text);
/// Bytes: "512M", "4G", "1.5G", "50%"; K, M, G, T are powers of 1024, % of the machine's memory.
Result<std::uint64_t> parse_size(std::string_view text);
/// Three numbers: "X,Y,Z".
Result<World3> parse_triple(std::string_view text);
/// A box: "XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX".
Result<WorldBox> parse_box(std::string_view text);
/// A triple, or one number for all three.
Result<World3> parse_scale(std::string_view text);

/// How much memory and how many threads a command may use.
struct LimitOptions {
  std::uint64_t memory_limit = 0;  ///< bytes; 0: default_limit()
  int threads = 0;                 ///< 0: all

  void declare(Arguments& arguments);
  /// The limit in bytes. Errors: kMemoryLimit below what the program itself needs.
  Result<std::uint64_t> limit() const;
};

/// Where words about the work go.
struct ReportOptions {
  std::string progress = "auto";
  std::string report;  ///< path of a JSON report; "-": stdout; empty: none

  void declare_progress(Arguments& arguments);
  void declare_report(Arguments& arguments);
};

/// The steps of integer coordinates in a file, chosen by hand or by pss.
struct ScaleChoice {
  bool automatic = false;  ///< the finest that holds the points
  std::optional<World3> steps;
};
/// "auto", or as parse_scale.
Result<ScaleChoice> parse_scale_or_auto(std::string_view text);

/// The scale and offset of an output of a format with an integer grid.
struct GridOptions {
  ScaleChoice scale;
  std::optional<World3> offset;

  void declare(Arguments& arguments);
  /// Gives them to a job.
  void put_into(JobRequest& job) const;
};

/// The names of some kinds, as the words of a choice.
template <class Kinds>
std::vector<std::string> names_of(const Kinds& kinds) {
  std::vector<std::string> names;
  for (const auto kind : kinds) names.emplace_back(name_of(kind));
  return names;
}

/// The one of that name; empty where no name was given.
template <class Kind, std::size_t n>
std::optional<Kind> named(const std::array<Kind, n>& kinds, const std::string& name) {
  const auto found = std::ranges::find(kinds, name, [](Kind kind) { return name_of(kind); });
  return found == kinds.end() ? std::nullopt : std::optional(*found);
}

/// Where a job keeps its work, and what becomes of what is there already.
void declare_work(Arguments& arguments, JobRequest& job);

/// Where it is remembered which outputs are complete: $XDG_STATE_HOME/pss, or ~/.local/state/pss;
/// empty where neither is known.
std::string state_folder();

/// --tile-points, of the jobs that sort.
void declare_tile_points(Arguments& arguments, JobRequest& job);

/// --drop-outside, which leaves far points out.
void declare_drop_outside(Arguments& arguments, std::optional<WorldBox>& box);

/// --overwrite alone, for commands that are no jobs.
void declare_overwrite(Arguments& arguments, bool& overwrite);

}  // namespace pss
