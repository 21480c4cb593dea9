#pragma once
// What a store keeps of each of its inputs, in a file of its own that is read only when needed.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/lattice.h"
#include "core/result.h"
#include "io/file/fingerprint.h"
#include "io/file/hash.h"
#include "io/points/points.h"
#include "stream/store/log.h"

namespace pss {

/// Which inputs made a store, and in which order: what its header knows of them.
struct InputsDigest {
  std::uint64_t count = 0;
  Hash128 hash;  ///< of all their records

  bool operator==(const InputsDigest&) const = default;
};

InputsDigest digest_of(std::span<const InputRecord> inputs);

/// What became of the points of one input.
struct InputCounts {
  std::uint64_t read = 0;
  std::uint64_t not_finite = 0;  ///< dropped: a coordinate is no finite number
  std::uint64_t outside = 0;     ///< dropped: outside the box that was to be kept
  std::uint64_t moved = 0;       ///< stored at a rounded position

  bool operator==(const InputCounts&) const = default;
};

/// An input without its head: some hundred bytes.
struct InputFacts {
  InputRecord record;
  std::string format;           ///< its name; this program may not know it
  std::optional<Lattice> grid;  ///< of its positions, where they are integers
  InputCounts counts;

  bool operator==(const InputFacts&) const = default;
};

/// The name of the table's file in a store's directory.
std::string inputs_path(const std::string& store);

/// The table of inputs of a complete store.
///
/// Memory: 8 bytes an input. A head is read by itself; who reads one has reserved kHeadCopies times
///         its head_size().
/// Errors: kBadInput, with file and offset, where the bytes are not those that were written.
class InputTable {
 public:
  /// Finds the entries; what they hold stays on the disk. `count` is how many there must be.
  static Result<InputTable> open(const std::string& store, std::optional<std::uint64_t> count = {});

  std::size_t size() const { return entries_.size(); }
  std::uint64_t bytes() const { return file_.size(); }  ///< of the file

  Result<InputFacts> facts(std::size_t input) const;
  /// Bytes of what head() and crs() give.
  Result<std::uint64_t> head_size(std::size_t input) const;
  /// The coordinate system, "" where it has none.
  Result<std::string> crs(std::size_t input) const;
  /// What a file of the same family of formats carries on; nothing where this program does not know
  /// the format.
  Result<std::optional<Carry>> head(std::size_t input) const;

  /// Reads all bytes against their checksums, some at a time; gives the digest of the inputs.
  Result<InputsDigest> check() const;

 private:
  explicit InputTable(LogFile file) : file_(std::move(file)) {}
  Result<void> find_entries(std::optional<std::uint64_t> count);
  Result<std::optional<LogPlace>> part_of(std::size_t input, std::uint32_t type) const;
  Error damaged(std::uint64_t offset, const std::string& what) const;
  LogFile file_;
  std::vector<std::uint64_t> entries_;  ///< offsets of their facts
};

/// Writes a table, front to back. Until finish() it counts for nothing, and may be written again.
class InputTableWriter {
 public:
  static Result<InputTableWriter> create(const std::string& store, std::uint64_t count);
  Result<void> add(const InputFacts& facts, std::string_view crs, const Carry& carry);
  /// Makes it durable.
  Result<void> finish() { return log_.sync(); }

 private:
  explicit InputTableWriter(LogWriter log) : log_(std::move(log)) {}
  LogWriter log_;
};

/// Gives the store `to`, which is made of the complete store `from`, the same table; durably.
///
/// Errors: kBadInput where the table of `from` is damaged.
/// Cost:   reads it twice, in pieces.
Result<void> copy_inputs(const std::string& from, const std::string& to);

}  // namespace pss
