#pragma once
// Hands written bytes to the disk while more are being made, so that the sync that counts is short.

#include <chrono>
#include <cstdint>
#include <future>
#include <string>

#include "io/file/file.h"

namespace pss {

/// By how many bytes a file grows between its syncs; tests make them small.
struct SyncSizes {
  /// Ahead: enough for the disk to write in one go, little enough not to pile up.
  std::uint64_t early = 32 << 20;
  /// That count: tiles share them; more is lost by a kill, fewer waits for the disk.
  std::uint64_t commit = 256 << 20;
};

/// Syncs a growing file beside its writer, by a descriptor of its own.
///
/// It promises nothing: whoever needs the bytes to be durable syncs the file after this, and hears
/// there of every failure. Thread: one.
class EarlySync {
 public:
  explicit EarlySync(std::uint64_t every) : every_(every) {}

  /// Says that the file has `bytes` bytes now; starts a sync where many are new and none runs.
  void grown(const std::string& path, std::uint64_t bytes) {
    if (bytes < begun_) begun_ = 0;  // another file
    if (bytes - begun_ < every_ || running()) return;
    begun_ = bytes;
    task_ = std::async(std::launch::async, [path] {
      if (auto file = File::open(path)) static_cast<void>(file->sync().has_value());
    });
  }

 private:
  bool running() const {
    return task_.valid() && task_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  }

  std::uint64_t every_;
  std::uint64_t begun_ = 0;
  std::future<void> task_;  ///< its destructor waits
};

}  // namespace pss
