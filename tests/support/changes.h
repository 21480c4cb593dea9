#pragma once
// What others may do to a file while it is read, and a monitor that does it at a chosen moment.

#include <algorithm>
#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "core/monitor.h"

namespace pss::test {

enum class Change { kReplaced, kGrown, kShrunk, kOverwritten };

inline constexpr std::array kChanges{Change::kReplaced, Change::kGrown, Change::kShrunk,
                                     Change::kOverwritten};

inline const char* name_of(Change change) {
  constexpr std::array kNames{"replaced", "grown", "shrunk", "overwritten"};
  return kNames[static_cast<std::size_t>(change)];
}

/// Copies up to 4 KiB of the second quarter over the middle, far from both ends of a file of 1 MB.
inline void overwrite_middle(const std::string& path) {
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(path));
  std::array<char, 4096> bytes{};
  const auto length = std::min<std::streamoff>(size / 4, bytes.size());
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekg(size / 4);
  file.read(bytes.data(), length);
  file.seekp(size / 2);
  file.write(bytes.data(), length);
}

/// A file like this one but for its middle takes its place.
inline void replace(const std::string& path) {
  std::filesystem::copy_file(path, path + ".new");
  overwrite_middle(path + ".new");
  std::filesystem::rename(path + ".new", path);
}

inline void make_change(Change change, const std::string& path) {
  const std::uintmax_t size = std::filesystem::file_size(path);
  if (change == Change::kReplaced) replace(path);
  if (change == Change::kGrown) std::filesystem::resize_file(path, size + 1000);
  if (change == Change::kShrunk) std::filesystem::resize_file(path, size / 2);
  if (change == Change::kOverwritten) overwrite_middle(path);
}

/// Acts once, when a stage begins or has come as far as `points`.
class ActingMonitor : public Monitor {
 public:
  ActingMonitor(std::string stage, std::uint64_t points, std::function<void()> act)
      : stage_(std::move(stage)), points_(points), act_(std::move(act)) {}

  void begin(std::string_view stage, std::uint64_t /*points*/, std::uint64_t /*tiles*/) override {
    now_ = stage;
    done_ = 0;
    act_if_due();
  }
  void advance(std::uint64_t points, std::uint64_t /*tiles*/) override {
    done_ += points;
    act_if_due();
  }
  bool acted() const { return acted_; }

 private:
  void act_if_due() {
    if (acted_ || now_ != stage_ || done_ < points_) return;
    acted_ = true;
    act_();
  }

  std::string stage_, now_;
  std::uint64_t points_, done_ = 0;
  std::function<void()> act_;
  bool acted_ = false;
};

}  // namespace pss::test
