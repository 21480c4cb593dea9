#include "stream/store/input_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "io/file/file.h"
#include "io/open.h"
#include "stream/store/log.h"

namespace pss {
namespace {

/// Of an input, as a name, a fingerprint, what is kept of its header, and JSON; and of its path, so
/// many copies. Measured: 2.4 KB for a path of 110 bytes.
constexpr std::uint64_t kInputBytes = 1600;
constexpr std::uint64_t kPathCopies = 8;
constexpr std::uint64_t kMiB = 1u << 20;

std::uint64_t memory_of_names(const std::vector<std::string>& inputs) {
  std::uint64_t bytes = 0;
  for (const std::string& input : inputs) bytes += kInputBytes + kPathCopies * input.size();
  return bytes;
}

std::uint64_t mib(std::uint64_t bytes) { return (bytes + kMiB - 1) / kMiB; }

/// What is asked of the limit before the first head is read.
struct Asked {
  std::uint64_t names = 0;
  std::uint64_t head = 0;  ///< all copies of it
  std::uint64_t work = 0;

  std::uint64_t held() const { return names + head; }
};

/// A limit that is only just enough for a head would leave the work little room; one that leaves it
/// what the smallest limit leaves runs what that runs.
Error refusal(const std::vector<std::string>& inputs, const Asked& asked,
              const MemoryBudget& budget) {
  const std::uint64_t left = budget.available();
  const std::uint64_t most = asked.held() + std::max(asked.work, budget.usual());
  return {Fault::kMemoryLimit,
          fmt::format("{}: the names of {} inputs take {} MiB of memory, {} copies of this one's "
                      "head {} MiB, and the work at least {} MiB, but the limit leaves {} MiB; use "
                      "--memory-limit {}M or more",
                      inputs.front(), inputs.size(), mib(asked.names), kHeadCopies, mib(asked.head),
                      mib(asked.work), left / kMiB, sufficient_mib(budget.limit(), left, most))};
}

/// A store that is not complete may have no table of inputs yet, and none that is whole.
Result<std::uint64_t> first_head_size(const std::string& store) {
  if (!exists(manifest_path(store)) || !exists(inputs_path(store))) return std::uint64_t{0};
  PSS_ASSIGN(const InputTable inputs, InputTable::open(store));
  return inputs.size() > 0 ? inputs.head_size(0) : std::uint64_t{0};
}

/// Where there is no store, none: whoever opens it says why not.
Result<std::uint64_t> header_size(const std::string& store) {
  if (!is_store(store)) return std::uint64_t{0};
  const std::string manifest = manifest_path(store);
  return first_record_size(exists(manifest) ? manifest : open_manifest_path(store));
}

Result<Reservation> take(const std::string& store, const char* what, std::uint64_t bytes,
                         MemoryBudget& budget) {
  if (auto reservation = budget.reserve(bytes)) return *std::move(reservation);
  return budget.refusal(fmt::format("{}: the {} with its work", store, what),
                        bytes + budget.usual());
}

}  // namespace

Result<Reservation> reserve_inputs(const std::vector<std::string>& inputs, const LeastMemory& least,
                                   MemoryBudget& budget) {
  PSS_ASSIGN(const std::unique_ptr<Reader> first,
             open_reader_holding(HeadBytes::kLeft, inputs.front()));
  const CloudHeader& cloud = first->header();
  StoreHeader header;
  header.schema = cloud.schema;
  Asked asked;
  asked.names = memory_of_names(inputs);
  asked.head = kHeadCopies * (cloud.carry_size + cloud.crs.size());
  // Of the first alone: how many points the others have is known, and asked for, once all are
  // opened.
  asked.work = least(header, cloud.count.value_or(0), first->unit());
  if (asked.held() + asked.work > budget.available()) return refusal(inputs, asked, budget);
  return budget.take(asked.held(), inputs.front());
}

Result<void> check_least(const StoreHeader& header, std::uint64_t points, std::size_t unit,
                         const LeastMemory& least, const MemoryBudget& budget) {
  const std::uint64_t work = least(header, points, unit);
  if (work <= budget.available()) return {};
  return budget.refusal(fmt::format("the work on rows of {} bytes", header.schema.row_size()),
                        work);
}

Result<Reservation> reserve_header(const std::string& store, MemoryBudget& budget) {
  PSS_ASSIGN(const std::uint64_t header, header_size(store));
  return take(store, "header", kHeaderCopies * header, budget);
}

Result<Reservation> reserve_header_and_head(const std::string& store, MemoryBudget& budget) {
  PSS_ASSIGN(const std::uint64_t header, header_size(store));
  PSS_ASSIGN(const std::uint64_t head, first_head_size(store));
  return take(store, "header and its first input's head",
              kHeaderCopies * header + kHeadCopies * head, budget);
}

}  // namespace pss
