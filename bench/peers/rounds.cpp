#include "bench/peers/rounds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace pss::bench {
namespace {

void run_once(const Cloud& cloud, const Rounds& rounds, Row& row) {
  const Smoothed smoothed =
      row.entry.who->smooth(cloud, {row.entry.radius, rounds.degree, rounds.threads});
  row.times.push_back(smoothed.time);
  row.sorts.push_back(smoothed.sort);
  row.neighbours = smoothed.neighbours;
  row.kept = smoothed.kept;
  if (row.times.size() == 1) row.errors = errors_of(cloud, smoothed.positions);
  fmt::print(stderr, "  {:38} R = {:5.2f} s: {:7.3f} s\n", row.entry.who->name(),
             row.entry.radius / cloud.spacing, smoothed.time.wall);
}

}  // namespace

double median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

std::vector<double> Row::seconds(bool without_sort) const {
  std::vector<double> all;
  const auto of = [&](const Time& time) { return threads == 1 ? time.cpu : time.wall; };
  for (std::size_t i = 0; i < times.size(); ++i)
    all.push_back(of(times[i]) - (without_sort ? of(sorts[i]) : 0));
  return all;
}

double Row::rate() const { return static_cast<double>(points) / median(seconds(false)); }

double Row::rate_sorted() const { return static_cast<double>(points) / median(seconds(true)); }

double Row::spread() const {
  const std::vector<double> all = seconds(false);
  const auto [least, most] = std::ranges::minmax(all);
  return (most - least) / median(all);
}

double Row::wall_over_cpu() const {
  double wall = 0, cpu = 0;
  for (const Time& time : times) wall += time.wall, cpu += time.cpu;
  return wall / cpu;
}

std::vector<Row> run_rounds(const Cloud& cloud, std::span<const Entry> entries,
                            const Rounds& rounds) {
  std::vector<Row> rows;
  for (const Entry& entry : entries)
    rows.push_back({.entry = entry, .points = cloud.points.size(), .threads = rounds.threads});
  for (int round = 0; round < rounds.count; ++round)
    for (std::size_t i = 0; i < rows.size(); ++i)
      run_once(cloud, rounds, rows[(i + static_cast<std::size_t>(round)) % rows.size()]);
  return rows;
}

}  // namespace pss::bench
