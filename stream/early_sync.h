#pragma once
// Hands written bytes to the disk while more are being made, so that the sync that counts is short.

#include <chrono>
#include <cstdint>
#include <future>
#include <string>

#include "io/file.h"

namespace pss {

/// Syncs a growing file beside its writer, by a descriptor of its own.
///
/// It promises nothing: whoever needs the bytes to be durable syncs the file after this, and hears
/// there of every failure. Thread: one.
class EarlySync {
 public:
  /// Says that the file has `bytes` bytes now; starts a sync where many are new and none runs.
  void grown(const std::string& path, std::uint64_t bytes) {
    if (bytes < begun_) begun_ = 0;  // another file
    if (bytes - begun_ < kEvery || running()) return;
    begun_ = bytes;
    task_ = std::async(std::launch::async, [path] {
      if (auto file = File::open(path)) static_cast<void>(file->sync().has_value());
    });
  }

 private:
  /// Enough for the disk to write in one go, little enough not to pile up.
  static constexpr std::uint64_t kEvery = 32 << 20;

  bool running() const {
    return task_.valid() && task_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  }

  std::uint64_t begun_ = 0;
  std::future<void> task_;  ///< its destructor waits
};

}  // namespace pss
