#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <numeric>

#include "bench/peers/modes.h"
#include "bench/peers/rounds.h"
#include "core/parallel.h"

namespace pss::bench {
namespace {

/// A process that makes its cloud, waits for the start and tells how fast it was.
class Worker {
 public:
  Worker(const Settings& settings, const Contender& who, std::size_t points, int threads) {
    if (pipe(start_) != 0 || pipe(answer_) != 0) return;
    id_ = fork();
    if (id_ == 0) {
      work(settings, who, points, threads);
      _exit(0);  // the child has nothing to clean up: the parent's buffers are not its own
    }
  }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;
  ~Worker() {
    for (const int end : {start_[0], start_[1], answer_[0], answer_[1]})
      if (end >= 0) close(end);
    if (id_ > 0) waitpid(id_, nullptr, 0);
  }

  bool ready() { return id_ > 0 && hear() == 1; }
  bool start() { return write(start_[1], "s", 1) == 1; }
  /// Points a second; 0 where the process failed.
  double rate() { return hear(); }

 private:
  void work(const Settings& settings, const Contender& who, std::size_t points, int threads) {
    SynthOptions options = settings.cloud;
    options.points = points;
    options.noise = settings.noises.front();
    const ThreadLimit limit(threads);
    const Result<Cloud> cloud = make_cloud(options);
    if (!cloud) return;
    tell(1);
    char started = 0;
    if (read(start_[0], &started, 1) != 1) return;
    const double radius = settings.radii.front() * cloud->spacing;
    const Smoothed smoothed = who.smooth(*cloud, {radius, settings.degree, threads});
    tell(static_cast<double>(points) / smoothed.time.wall);
  }

  void tell(double value) { static_cast<void>(!write(answer_[1], &value, sizeof value)); }

  double hear() {
    // Without the parent's own writing end, reading ends where the child does.
    if (answer_[1] >= 0) close(answer_[1]);
    answer_[1] = -1;
    double value = 0;
    return read(answer_[0], &value, sizeof value) == sizeof value ? value : 0;
  }

  int start_[2] = {-1, -1};
  int answer_[2] = {-1, -1};
  pid_t id_ = -1;
};

/// The rates of so many processes together that start at once, each with its share of the points.
double rate_of(const Settings& settings, const Contender& who, int processes, int threads) {
  const std::size_t share = settings.cloud.points / static_cast<std::size_t>(processes);
  std::vector<std::unique_ptr<Worker>> workers;
  for (int i = 0; i < processes; ++i)
    workers.push_back(std::make_unique<Worker>(settings, who, share, threads));
  for (const auto& worker : workers)
    if (!worker->ready()) return 0;
  for (const auto& worker : workers) worker->start();
  double rate = 0;
  for (const auto& worker : workers) rate += worker->rate();
  return rate;
}

}  // namespace

Result<void> compare_with_processes(const Settings& settings, const Contenders& contenders,
                                    Report& report) {
  const int n = settings.threads.back();
  for (const auto& who : contenders) {
    if (who->peer()) continue;
    std::vector<double> threads, processes;
    for (int round = 0; round < settings.runs; ++round) {
      threads.push_back(rate_of(settings, *who, 1, n));
      processes.push_back(rate_of(settings, *who, n, 1));
      fmt::print(stderr, "  {:38} {} threads {:.0f}, processes {:.0f} points/s\n", who->name(), n,
                 threads.back(), processes.back());
    }
    if (median(processes) <= 0) return Error{Fault::kFailed, "no process could be started"};
    report.add_processes(who->name(), n, median(threads), median(processes));
  }
  return {};
}

}  // namespace pss::bench
