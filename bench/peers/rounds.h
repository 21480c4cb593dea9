#pragma once
// Runs contenders in turn, round after round, and keeps what each took.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/peers/contender.h"

namespace pss::bench {

double median(std::vector<double> values);

/// Who runs, and with which radius.
struct Entry {
  const Contender* who = nullptr;
  double radius = 0;
};

/// What became of an entry.
struct Row {
  Entry entry;
  std::vector<Time> times, sorts;  ///< of every round
  std::size_t points = 0;
  int threads = 1;
  double neighbours = 0;
  std::size_t kept = 0;
  Errors errors;

  /// Points a second by the median of all rounds: processor time on one thread, which others on
  /// the machine disturb least, else time on the wall.
  double rate() const;
  /// The same without sorting.
  double rate_sorted() const;
  /// From the fastest round to the slowest, over the median.
  double spread() const;
  /// Time on the wall over processor time; above 1 on one thread, the machine was busy.
  double wall_over_cpu() const;

 private:
  std::vector<double> seconds(bool without_sort) const;
};

struct Rounds {
  int degree = 3;
  int threads = 1;
  int count = 5;
};

/// Every entry runs once a round; each round begins with the next entry.
std::vector<Row> run_rounds(const Cloud& cloud, std::span<const Entry> entries,
                            const Rounds& rounds);

}  // namespace pss::bench
