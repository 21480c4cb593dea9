#pragma once
// The memory limit: every large allocation is reserved here before it is made.

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "core/result.h"

namespace pss {

class MemoryBudget;

/// A share of the limit, given back at the end of its life.
class Reservation {
 public:
  Reservation() = default;
  Reservation(Reservation&& other) noexcept;
  Reservation& operator=(Reservation&& other) noexcept;
  ~Reservation();

  std::uint64_t bytes() const { return bytes_; }
  void release();
  /// Gives back all but `bytes`.
  void shrink_to(std::uint64_t bytes);

 private:
  friend class MemoryBudget;
  Reservation(MemoryBudget* budget, std::uint64_t bytes) : budget_(budget), bytes_(bytes) {}
  MemoryBudget* budget_ = nullptr;
  std::uint64_t bytes_ = 0;
};

/// What the limit leaves for data, after the program itself and its threads.
///
/// Thread: any.
class MemoryBudget {
 public:
  /// Errors: none; a limit below minimum_limit(threads) leaves nothing.
  MemoryBudget(std::uint64_t limit, int threads);

  std::uint64_t limit() const { return limit_; }
  std::uint64_t total() const { return total_; }  ///< bytes for data
  std::uint64_t available() const { return total_ - used_.load(); }

  /// Takes `bytes` as a whole or not at all.
  std::optional<Reservation> reserve(std::uint64_t bytes);
  /// The same, or the refusal().
  Result<Reservation> take(std::uint64_t bytes, const std::string& what);
  /// Grows a reservation of this budget, or an empty one, to `bytes`, or leaves it as it is.
  bool grow(Reservation& reservation, std::uint64_t bytes);

  /// Says that `what`, which takes `bytes` beside what is held now, does not fit, and the limit
  /// that does; `or_else` is another way out, as ", or --h".
  Error refusal(const std::string& what, std::uint64_t bytes,
                const std::string& or_else = {}) const;
  /// What the smallest limit leaves for data: work of no unusual size runs in it.
  std::uint64_t usual() const { return usual_; }

 private:
  friend class Reservation;
  std::uint64_t limit_;
  std::uint64_t usual_;
  std::uint64_t total_;
  std::atomic<std::uint64_t> used_{0};
};

/// The limit, in MiB, that leaves `needed` bytes where `limit` leaves `left`: what every refusal
/// names.
std::uint64_t sufficient_mib(std::uint64_t limit, std::uint64_t left, std::uint64_t needed);

/// The smallest limit that any job runs with.
std::uint64_t minimum_limit(int threads);

/// The limit where the user names none: 70 % of what the machine or its cgroup has.
std::uint64_t default_limit();
/// What the machine or its cgroup has.
std::uint64_t machine_memory();

/// Peak resident memory of this process (VmHWM), and what is resident now.
std::uint64_t peak_resident();
std::uint64_t current_resident();

/// Makes freed memory go back to the system at once; called first in main.
void configure_allocator();

}  // namespace pss
