#include "apps/options.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>

#include "core/parallel.h"
#include "io/formats/table.h"
#include "stream/limit/memory.h"

namespace pss {

namespace {

/// More only wait for each other, and each takes memory.
constexpr int kMostThreadsPerProcessor = 8;

Error usage(std::string_view text, std::string_view expected) {
  return {Fault::kUsage, fmt::format("found '{}', expected {}", text, expected)};
}

/// The number at the front of `text`, which is cut off it.
std::optional<double> take_number(std::string_view& text) {
  double value = 0;
  auto [rest, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(rest - text.data()));
  return value;
}

/// Whether `text` is that many numbers with commas between them, and nothing else.
bool take_numbers(std::string_view text, std::span<double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (i > 0 && !text.starts_with(',')) return false;
    if (i > 0) text.remove_prefix(1);
    const std::optional<double> value = take_number(text);
    if (!value) return false;
    values[i] = *value;
  }
  return text.empty();
}

/// `base` to the power that a suffix stands for: k 1, M 2, G 3, T 4; none 0.
std::optional<double> suffix_factor(std::string_view suffix, double base) {
  if (suffix.empty()) return 1;
  constexpr std::string_view kLetters = "kmgt";
  const auto letter = static_cast<char>(std::tolower(static_cast<unsigned char>(suffix[0])));
  const std::size_t power = kLetters.find(letter);
  if (suffix.size() != 1 || power == std::string_view::npos) return std::nullopt;
  return std::pow(base, static_cast<double>(power + 1));
}

std::optional<std::uint64_t> as_whole(double value) {
  if (!(value >= 0 && value < 9e18)) return std::nullopt;
  return static_cast<std::uint64_t>(value);
}

}  // namespace

Result<std::string> parse_text(std::string_view text) { return std::string(text); }

Result<std::string> parse_output(std::string_view text) {
  while (text.size() > 1 && text.ends_with('/')) text.remove_suffix(1);
  return std::string(text);
}

Result<double> parse_number(std::string_view text) {
  std::string_view rest = text;
  std::optional<double> value = take_number(rest);
  if (!value || !rest.empty()) return usage(text, "a number such as 0.5 or 1e-3");
  return *value;
}

Result<double> parse_positive(std::string_view text) {
  PSS_ASSIGN(const double value, parse_number(text));
  if (!(value > 0)) return usage(text, "a number above zero");
  return value;
}

Result<int> parse_integer(std::string_view text) {
  int value = 0;
  auto [rest, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || rest != text.data() + text.size() || value < 0)
    return usage(text, "a whole number such as 4");
  return value;
}

Result<int> parse_threads(std::string_view text) {
  PSS_ASSIGN(const int threads, parse_integer(text));
  const int most = kMostThreadsPerProcessor * thread_count();
  if (threads > most)
    return usage(text,
                 fmt::format("at most {}: this machine runs {} at once", most, thread_count()));
  return threads;
}

Result<std::uint64_t> parse_count(std::string_view text) {
  constexpr const char* kExpected = "a whole number such as 1000, 10k, 2M or 1e9";
  std::uint64_t exact = 0;  // a double would round seeds and counts above 2^53
  auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), exact);
  if (fault == std::errc() && end == text.data() + text.size()) return exact;
  std::string_view rest = text;
  std::optional<double> number = take_number(rest);
  std::optional<double> factor = suffix_factor(rest, 1000);
  if (!number || !factor) return usage(text, kExpected);
  const double value = *number * *factor;
  std::optional<std::uint64_t> whole = as_whole(value);
  if (!whole || static_cast<double>(*whole) != value) return usage(text, kExpected);
  return *whole;
}

Result<std::uint32_t> parse_tile_points(std::string_view text) {
  PSS_ASSIGN(const std::uint64_t count, parse_count(text));
  if (count == 0 || count > (1u << 30)) return usage(text, "a count from 1 to 2^30");
  return static_cast<std::uint32_t>(count);
}

Result<std::uint64_t> parse_size(std::string_view text) {
  constexpr const char* kExpected = "a size such as 512M, 4G or 50%";
  std::string_view rest = text;
  std::optional<double> number = take_number(rest);
  if (!number) return usage(text, kExpected);
  const bool share = rest == "%";
  std::optional<double> factor =
      share ? static_cast<double>(machine_memory()) / 100 : suffix_factor(rest, 1024);
  if (!factor || (share && *number > 100)) return usage(text, kExpected);
  std::optional<std::uint64_t> bytes = as_whole(*number * *factor);
  if (!bytes || *bytes == 0) return usage(text, kExpected);
  return *bytes;
}

Result<World3> parse_triple(std::string_view text) {
  World3 values{};
  if (!take_numbers(text, values)) return usage(text, "three numbers X,Y,Z");
  return values;
}

Result<WorldBox> parse_box(std::string_view text) {
  std::array<double, 6> ends{};
  WorldBox box;
  bool good = take_numbers(text, ends);
  for (std::size_t a = 0; a < 3; ++a) {
    box.min[a] = ends[a];
    box.max[a] = ends[a + 3];
    good = good && box.min[a] <= box.max[a];
  }
  if (!good) return usage(text, "six numbers XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX, least ends first");
  return box;
}

Result<World3> parse_scale(std::string_view text) {
  Result<World3> values = parse_triple(text);
  if (Result<double> one = parse_positive(text)) values = World3{*one, *one, *one};
  if (!values) return usage(text, "one number above zero, or three as X,Y,Z");
  for (double value : *values)
    if (!(value > 0)) return usage(text, "numbers above zero");
  return values;
}

void LimitOptions::declare(Arguments& arguments) {
  arguments.option("--memory-limit", "SIZE",
                   "Most memory that pss may use: 512M, 4G (2^20, 2^30 bytes), 50% "
                   "[70% of what the machine or its cgroup has]",
                   memory_limit, parse_size);
  arguments.option("--threads", "N", "Threads to compute with; 0: all [0]", threads, parse_threads);
}

Result<std::uint64_t> LimitOptions::limit() const {
  const std::uint64_t given = memory_limit ? memory_limit : default_limit();
  const std::uint64_t least = minimum_limit(threads > 0 ? threads : thread_count());
  if (given >= least) return given;
  return Error{Fault::kMemoryLimit,
               fmt::format("--memory-limit: found {} bytes, expected at least {} bytes ({} MiB) "
                           "for the program and its threads; use --memory-limit {}M or more",
                           given, least, least >> 20, least >> 20)};
}

void ReportOptions::declare_progress(Arguments& arguments) {
  arguments.choice("--progress", {"auto", "bar", "plain", "json", "none"},
                   "How to tell that work advances, on stderr: a bar, plain lines, JSON lines; "
                   "auto is a bar on a terminal, else plain lines [auto]",
                   progress);
}

void ReportOptions::declare_report(Arguments& arguments) {
  arguments.option(
      "--report", "FILE",
      "Write a JSON report at the end, \"-\" to stdout; an existing file is replaced only "
      "with --overwrite; keys: docs/report.md",
      report, parse_text);
}

Result<ScaleChoice> parse_scale_or_auto(std::string_view text) {
  if (text == "auto") return ScaleChoice{.automatic = true, .steps = std::nullopt};
  PSS_ASSIGN(const World3 steps, parse_scale(text));
  return ScaleChoice{.automatic = false, .steps = steps};
}

void GridOptions::declare(Arguments& arguments) {
  const std::string gridded = gridded_formats(", ");
  arguments.option("--scale", "S|X,Y,Z|auto",
                   gridded +
                       ": step of the written coordinates; auto: the finest that holds them "
                       "[the input's]",
                   scale, parse_scale_or_auto);
  arguments.option("--offset", "X,Y,Z",
                   gridded + ": origin of the written coordinates [the input's]", offset,
                   parse_triple);
}

void GridOptions::put_into(JobRequest& job) const {
  job.scale = scale.steps;
  job.scale_auto = scale.automatic;
  job.offset = offset;
}

void declare_work(Arguments& arguments, JobRequest& job) {
  arguments.option("--work-dir", "DIR",
                   "Where the job keeps its work; its record stays there [OUTPUT.work, gone after "
                   "success]",
                   job.work_dir, parse_text);
  arguments.flag("--keep-work", "Keep the work directory whole after success", job.keep_work);
  arguments.flag("--overwrite", "Replace an existing OUTPUT, at the end and not before",
                 job.overwrite);
  arguments.flag("--restart", "Discard the work directory instead of going on with it",
                 job.restart);
}

std::string state_folder() {
  const char* state = std::getenv("XDG_STATE_HOME");
  if (state && *state == '/') return std::string(state) + "/pss";  // its standard wants it absolute
  const char* home = std::getenv("HOME");
  return home && *home == '/' ? std::string(home) + "/.local/state/pss" : "";
}

void declare_tile_points(Arguments& arguments, JobRequest& job) {
  arguments.option("--tile-points", "N", "Points a tile owns at most, for experiments [262144]",
                   job.tile_points, parse_tile_points);
}

void declare_drop_outside(Arguments& arguments, std::optional<WorldBox>& box) {
  arguments.option("--drop-outside", "BOX",
                   "Leave out the points outside this box, and count them: "
                   "XMIN,YMIN,ZMIN,XMAX,YMAX,ZMAX; for stray points so far away that coordinates "
                   "lose their precision [keep all]",
                   box, parse_box);
}

void declare_overwrite(Arguments& arguments, bool& overwrite) {
  arguments.flag("--overwrite", "Replace an existing OUTPUT, at the end and not before", overwrite);
}

}  // namespace pss
