// How fast is pss beside its peers, on one cloud, and who comes nearest to the true surface?

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <thread>

#include "bench/peers/modes.h"

namespace pss::bench {
namespace {

constexpr const char* kDescription =
    "Compares pss with PCL and CGAL: equal radius, equal error, threads against processes, and\n"
    "what each computes with a slow reference.\n"
    "Lengths in spacings s; tables to stdout, progress to stderr. Rates on one thread are by\n"
    "processor time, else by time on the wall; of pss with sorting and building the grid, of\n"
    "peers with building their trees. All read and write arrays in memory.";

struct Words {
  std::string mode;
  std::string surface = "torus";
  std::string order = "sweep";
  std::string json;
  std::vector<std::string> names;
  std::vector<std::string> scans;
};

void declare(CLI::App& app, Settings& settings, Words& words) {
  app.add_option("mode", words.mode, "What to measure")
      ->required()
      ->check(CLI::IsMember({"equal-radius", "equal-error", "processes", "reference"}));
  app.add_option("scan", words.scans, "For reference: files of real scans");
  app.add_option("--surface", words.surface, "torus, sphere, plane or terrain")
      ->capture_default_str();
  app.add_option("--order", words.order, "Of the input: sweep, as scanners do, or scattered")
      ->check(CLI::IsMember({"sweep", "scattered"}))
      ->capture_default_str();
  app.add_option("--points", settings.cloud.points)->capture_default_str();
  app.add_option("--noise", settings.noises, "Standard deviations in s, a table each")
      ->capture_default_str();
  app.add_option("--radius", settings.radii,
                 "Radii in s, a table each; equal-error and reference take the last")
      ->capture_default_str();
  app.add_option("--largest-radius", settings.largest_radius, "In s, for equal-error")
      ->capture_default_str();
  app.add_option("--cgal-radius", settings.cgal_radius, "In s; CGAL takes part up to it")
      ->capture_default_str();
  app.add_option("--threads", settings.threads, "A table each [1 and all]");
  app.add_option("--polynomial-order", settings.degree)->capture_default_str();
  app.add_option("--runs", settings.runs, "Rounds; the median counts")->capture_default_str();
  app.add_option("--only", words.names, "Only contenders whose name holds one of these");
  app.add_option("--json", words.json, "Also save all numbers in this file");
}

bool wanted(const Words& words, const std::string& name) {
  return words.names.empty() || std::ranges::any_of(words.names, [&](const std::string& part) {
           return name.find(part) != std::string::npos;
         });
}

/// Peers first: others are compared with the first.
Contenders contenders_for(const Words& words) {
  Contenders contenders;
#ifdef PSS_HAVE_PCL
  add_pcl(contenders);
#endif
#ifdef PSS_HAVE_CGAL
  add_cgal(contenders);
#endif
  add_pss(contenders);
  std::erase_if(contenders, [&](const auto& who) { return !wanted(words, who->name()); });
  return contenders;
}

Result<void> run(Settings& settings, const Words& words) {
  if (words.mode == "reference") return compare_with_reference(settings, words.scans);
  PSS_ASSIGN(settings.cloud.surface, make_surface(words.surface, {}));
  settings.cloud.order = words.order == "sweep" ? SynthOrder::kSweep : SynthOrder::kScattered;
  if (settings.threads.empty())
    settings.threads = {1, static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))};
  const Contenders contenders = contenders_for(words);
  if (contenders.empty()) return Error{Fault::kUsage, "--only: no contender has such a name"};
  const auto compare = words.mode == "equal-radius"  ? compare_at_equal_radius
                       : words.mode == "equal-error" ? compare_at_equal_error
                                                     : compare_with_processes;
  Report report;
  PSS_TRY(compare(settings, contenders, report));
  if (words.json.empty()) return {};
  return report.save(words.json);
}

int main_of(int argc, char** argv) {
  CLI::App app(kDescription, "bench_peers");
  Settings settings;
  Words words;
  declare(app, settings, words);
  CLI11_PARSE(app, argc, argv);
  const Result<void> result = run(settings, words);
  if (result) return 0;
  fmt::print(stderr, "bench_peers: {}\n", result.error().message);
  return static_cast<int>(result.error().fault);
}

}  // namespace
}  // namespace pss::bench

int main(int argc, char** argv) { return pss::bench::main_of(argc, argv); }
