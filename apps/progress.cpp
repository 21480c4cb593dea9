#include "apps/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

#include "apps/standard_streams.h"
#include "stream/limit/memory.h"

namespace pss {

namespace {

constexpr double kRateWindow = 10;  // seconds over which points/s is measured

std::size_t terminal_columns() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

}  // namespace

Progress::Style Progress::style_of(std::string_view word) {
  if (word == "bar") return Style::kBar;
  if (word == "plain") return Style::kPlain;
  if (word == "json") return Style::kJson;
  if (word == "none") return Style::kNone;
  return isatty(STDERR_FILENO) ? Style::kBar : Style::kPlain;
}

std::chrono::milliseconds Progress::interval() const {
  using namespace std::chrono_literals;
  if (style_ == Style::kBar) return 200ms;
  return style_ == Style::kJson ? 1000ms : 5000ms;
}

Progress::Progress(std::string_view style)
    : style_(style_of(style)), drawer_([this] { draw_until_done(); }) {}

Progress::~Progress() {
  {
    std::lock_guard lock(mutex_);
    done_ = true;
  }
  wake_.notify_all();
  drawer_.join();
  if (style_ == Style::kJson && !stage_.empty()) draw();
  erase_bar();
}

double Progress::seconds() const {
  return std::chrono::duration<double>(Clock::now() - start_).count();
}

void Progress::begin(std::string_view stage, std::uint64_t total_points,
                     std::uint64_t total_tiles) {
  std::lock_guard lock(mutex_);
  if (style_ == Style::kJson && !stage_.empty()) draw();
  stage_ = stage;
  total_points_ = total_points;
  total_tiles_ = total_tiles;
  points_ = 0;
  tiles_ = 0;
  recent_.clear();
  sample();
  if (style_ == Style::kJson) draw();
}

void Progress::advance(std::uint64_t points, std::uint64_t tiles) {
  points_.fetch_add(points, std::memory_order_relaxed);
  tiles_.fetch_add(tiles, std::memory_order_relaxed);
}

void Progress::note(std::string_view text) {
  std::lock_guard lock(mutex_);
  say(text);
}

bool Progress::stopping() const { return signals_.stopping(); }

void Progress::draw_until_done() {
  std::unique_lock lock(mutex_);
  while (!wake_.wait_for(lock, interval(), [this] { return done_; })) {
    if (stopping() && !stop_said_) {
      stop_said_ = true;
      say("stopping; press Ctrl-C again to quit at once");
    }
    if (stage_.empty()) continue;
    sample();
    draw();
  }
}

void Progress::sample() {
  const double now = seconds();
  while (recent_.size() > 1 && recent_[1].seconds < now - kRateWindow) recent_.pop_front();
  recent_.push_back({now, points_.load(std::memory_order_relaxed)});
}

Snapshot Progress::snapshot() const {
  Snapshot now{.stage = stage_,
               .points = points_.load(std::memory_order_relaxed),
               .total_points = total_points_,
               .tiles = tiles_.load(std::memory_order_relaxed),
               .total_tiles = total_tiles_,
               .seconds = seconds(),
               .points_per_second = 0,
               .resident_bytes = current_resident()};
  const Sample& oldest = recent_.front();
  const double elapsed = now.seconds - oldest.seconds;
  if (elapsed > 0 && now.points > oldest.points)
    now.points_per_second = static_cast<double>(now.points - oldest.points) / elapsed;
  return now;
}

void Progress::draw() {
  if (style_ == Style::kPlain) print_words(plain_line(snapshot()) + "\n");
  if (style_ == Style::kJson) print_words(json_line(snapshot()) + "\n");
  if (style_ != Style::kBar) return;
  print_words(fmt::format("\r{}\x1b[K", bar_line(snapshot(), terminal_columns() - 1)));
  bar_shown_ = true;
}

void Progress::erase_bar() {
  if (bar_shown_) print_words("\r\x1b[K");
  bar_shown_ = false;
}

void Progress::say(std::string_view text) {
  erase_bar();
  if (style_ == Style::kJson)
    print_words(json_note(text) + "\n");
  else
    print_words(fmt::format("pss: {}\n", text));
}

}  // namespace pss
