#pragma once
// Tells on stderr how far the work is, and passes signals on to it.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

#include "apps/progress_view.h"
#include "apps/signals.h"
#include "core/monitor.h"

namespace pss {

/// The Monitor of one command, from its making to its end.
///
/// Thread: a thread of its own draws, so that the time moves even while the work does not.
class Progress : public Monitor {
 public:
  /// `style` is a word of --progress: auto, bar, plain, json, none.
  explicit Progress(std::string_view style);
  ~Progress() override;
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void begin(std::string_view stage, std::uint64_t total_points,
             std::uint64_t total_tiles) override;
  void advance(std::uint64_t points, std::uint64_t tiles) override;
  void note(std::string_view text) override;
  bool stopping() const override;

  /// Seconds since the making.
  double seconds() const;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Style { kBar, kPlain, kJson, kNone };
  struct Sample {
    double seconds;
    std::uint64_t points;
  };

  static Style style_of(std::string_view word);
  std::chrono::milliseconds interval() const;
  void draw_until_done();
  // These need the mutex.
  void sample();
  Snapshot snapshot() const;
  void draw();
  void erase_bar();
  void say(std::string_view text);

  const Style style_;
  const Clock::time_point start_ = Clock::now();
  SignalWatch signals_;
  std::atomic<std::uint64_t> points_{0};
  std::atomic<std::uint64_t> tiles_{0};

  std::mutex mutex_;
  std::condition_variable wake_;
  std::string stage_;  ///< empty: nothing to draw yet
  std::uint64_t total_points_ = 0;
  std::uint64_t total_tiles_ = 0;
  std::deque<Sample> recent_;  ///< of this stage, over the last seconds
  bool bar_shown_ = false;
  bool stop_said_ = false;
  bool done_ = false;
  std::thread drawer_;
};

}  // namespace pss
