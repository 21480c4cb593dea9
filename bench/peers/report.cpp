#include "bench/peers/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace pss::bench {
namespace {

/// Above this much time on the wall for one second of a processor, others used the machine.
constexpr double kBusy = 1.03;
/// By how much the neighbours of two contenders may differ at one radius.
constexpr double kSameNeighbours = 0.01;

/// A rate for a table: thousands, with three digits or so.
std::string thousands(double rate) {
  return fmt::format("{:.{}f}", rate / 1000, rate < 100'000 ? 1 : 0);
}

void print_row(const Row& row, const Row& first, double spacing) {
  fmt::print("| {} | {:.2f} | {:.1f} | {} | {} | {:.1f} % | {:.2f} | {:.6f} | {} | {} |\n",
             row.entry.who->name(), row.entry.radius / spacing, row.neighbours,
             thousands(row.rate()), row.entry.who->peer() ? "" : thousands(row.rate_sorted()),
             100 * row.spread(), row.rate() / first.rate(), row.errors.rms, row.errors.lost,
             row.kept);
}

/// What makes a table doubtful, in words below it.
void print_doubts(std::span<const Row> rows) {
  const Row& first = rows.front();
  double busy = 0;
  for (const Row& row : rows) {
    if (row.threads == 1) busy = std::max(busy, row.wall_over_cpu());
    const bool same_ball = !row.entry.who->peer() && row.entry.radius == first.entry.radius;
    if (same_ball && std::abs(row.neighbours / first.neighbours - 1) > kSameNeighbours)
      fmt::print("\nDoubt: {} has {:.2f} neighbours, {} {:.2f}.\n", row.entry.who->name(),
                 row.neighbours, first.entry.who->name(), first.neighbours);
  }
  if (busy > kBusy)
    fmt::print("\nDoubt: a busy machine, up to {:.2f} s passed for each second of work.\n", busy);
}

nlohmann::json to_json(const Row& row, double spacing) {
  nlohmann::json walls = nlohmann::json::array(), cpus = walls, sorts = walls;
  for (const Time& time : row.times) walls.push_back(time.wall), cpus.push_back(time.cpu);
  for (const Time& sort : row.sorts) sorts.push_back(sort.wall);
  return {{"name", row.entry.who->name()},
          {"radius", row.entry.radius / spacing},
          {"points", row.points},
          {"threads", row.threads},
          {"neighbours", row.neighbours},
          {"rate", row.rate()},
          {"rate_without_sort", row.rate_sorted()},
          {"rms_error", row.errors.rms},
          {"lost", row.errors.lost},
          {"kept", row.kept},
          {"wall_seconds", walls},
          {"cpu_seconds", cpus},
          {"sort_wall_seconds", sorts}};
}

}  // namespace

void Report::add(const Caption& caption, std::span<const Row> rows) {
  if (rows.empty()) return;
  const std::string name = rows.front().entry.who->name();
  fmt::print("\n**{}**\n\n", caption.text);
  fmt::print(
      "| | R / s | neighbours | k points/s | without sort | spread | x {} | "
      "rms error / s | lost | kept |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
      name.substr(0, name.find(' ')));
  for (const Row& row : rows) print_row(row, rows.front(), caption.spacing);
  print_doubts(rows);
  std::fflush(stdout);
  nlohmann::json all = nlohmann::json::array();
  for (const Row& row : rows) all.push_back(to_json(row, caption.spacing));
  tables_.push_back({{"caption", caption.text}, {"noise", caption.noise}, {"rows", all}});
}

void Report::add_processes(const std::string& name, int threads, double threads_rate,
                           double processes_rate) {
  if (processes_.empty())
    fmt::print(
        "\n**One program on n threads, and n programs on one thread each**\n\n"
        "| | n | threads, k points/s | processes, k points/s | ratio |\n"
        "|---|--:|--:|--:|--:|\n");
  fmt::print("| {} | {} | {} | {} | {:.3f} |\n", name, threads, thousands(threads_rate),
             thousands(processes_rate), threads_rate / processes_rate);
  std::fflush(stdout);
  processes_.push_back({{"name", name},
                        {"threads", threads},
                        {"threads_rate", threads_rate},
                        {"processes_rate", processes_rate}});
}

Result<void> Report::save(const std::string& path) const {
  std::ofstream file(path);
  file << nlohmann::json{{"tables", tables_}, {"processes", processes_}}.dump(1) << '\n';
  if (!file.flush()) return Error{Fault::kFailed, path + ": cannot be written"};
  return {};
}

}  // namespace pss::bench
