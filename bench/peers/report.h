#pragma once
// Prints what was measured as Markdown tables and saves it as JSON.

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "bench/peers/rounds.h"

namespace pss::bench {

/// Whose radius and whose error a table is about, in words and numbers.
struct Caption {
  std::string text;
  double spacing = 1;
  double noise = 0;  ///< in spacings
};

class Report {
 public:
  /// Prints a table whose first row is what the others are compared with.
  void add(const Caption& caption, std::span<const Row> rows);

  /// Prints how `threads` threads compare with as many processes.
  void add_processes(const std::string& name, int threads, double threads_rate,
                     double processes_rate);

  /// Errors: kFailed where the file cannot be written.
  Result<void> save(const std::string& path) const;

 private:
  nlohmann::json tables_ = nlohmann::json::array();
  nlohmann::json processes_ = nlohmann::json::array();
};

}  // namespace pss::bench
