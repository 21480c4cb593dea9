#pragma once
// Workspaces that tasks hand on to one another.

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace pss {

/// What tasks leave for those that come after them, so that each thread makes one.
///
/// Thread: any.
template <class T>
class Spares {
 public:
  /// Empty where none is left: make one.
  std::unique_ptr<T> take() {
    const std::lock_guard lock(mutex_);
    if (spares_.empty()) return nullptr;
    std::unique_ptr<T> spare = std::move(spares_.back());
    spares_.pop_back();
    return spare;
  }

  void give(std::unique_ptr<T> spare) {
    const std::lock_guard lock(mutex_);
    spares_.push_back(std::move(spare));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> spares_;
};

}  // namespace pss
