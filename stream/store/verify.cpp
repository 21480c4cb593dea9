#include "stream/store/verify.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>
#include <utility>

#include "core/morton.h"
#include "stream/store/input_memory.h"
#include "stream/store/keyed_rows.h"
#include "stream/store/store.h"

namespace pss {
namespace {

/// Rows as they are hashed: three int64, then the bytes of the row.
std::vector<std::byte> interleave(std::span<const Index3> positions,
                                  std::span<const std::byte> rows, std::size_t row_size) {
  const std::size_t stride = sizeof(Index3) + row_size;
  std::vector<std::byte> out(positions.size() * stride);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    std::memcpy(out.data() + i * stride, &positions[i], sizeof(Index3));
    if (row_size > 0)
      std::memcpy(out.data() + i * stride + sizeof(Index3), rows.data() + i * row_size, row_size);
  }
  return out;
}

/// The table of inputs, to its last byte, and whether it is of those that the header knows.
Result<void> check_inputs(const Store& store) {
  if (!store.complete() || store.header().inputs.count == 0) return {};
  PSS_ASSIGN(const InputTable inputs, store.inputs());
  PSS_ASSIGN(const InputsDigest found, inputs.check());
  if (found == store.header().inputs) return {};
  return Error{
      Fault::kBadInput,
      fmt::format("{}: damaged at offset {}: the inputs are not those of the store's header",
                  inputs_path(store.path()), LogFile::kFirst)};
}

class Verifier {
 public:
  Verifier(const Store& store, Monitor& monitor)
      : store_(store), monitor_(monitor), row_size_(store.header().schema.row_size()) {}

  Result<VerifySummary> run() {
    summary_.complete = store_.complete();
    summary_.bytes = store_.bytes_on_disk();
    monitor_.begin("verify", store_.points(), store_.tiles().size());
    for (std::size_t t = 0; t < store_.tiles().size(); ++t) {
      if (monitor_.stopping()) return Error{Fault::kInterrupted, "stopped while verifying"};
      if (auto checked = check_tile(t); !checked) {
        if (checked.error().fault != Fault::kBadInput) return checked.error();
        note(checked.error().message);
      }
      monitor_.advance(store_.tiles()[t].count, 1);
    }
    if (auto checked = check_inputs(store_); !checked) {
      if (checked.error().fault != Fault::kBadInput) return checked.error();
      note(checked.error().message);
    }
    summary_.tiles = store_.tiles().size();
    summary_.rows = hash_.digest();
    return std::move(summary_);
  }

 private:
  void note(std::string damage) {
    if (summary_.damage.size() < kMostDamage) summary_.damage.push_back(std::move(damage));
    ++summary_.damage_count;
  }

  void note(const TileInfo& tile, const std::string& what) {
    note(fmt::format("{}: damaged at offset {}: {}", segment_path(store_.path(), tile.segment),
                     tile.offset, what));
  }

  /// Errors: kBadInput where its index cannot be read; other damage is noted.
  Result<void> check_tile(std::size_t t) {
    const TileInfo& tile = store_.tiles()[t];
    check_cell(t);
    PSS_ASSIGN(const auto blocks, store_.read_index(t));
    IndexBox box;
    for (const BlockInfo& block : blocks) {
      if (monitor_.stopping()) return Error{Fault::kInterrupted, "stopped while verifying"};
      box.add(block.box);
      if (auto checked = check_block(tile, block); !checked) {
        if (checked.error().fault != Fault::kBadInput) return checked;
        note(checked.error().message);
        last_.reset();
      }
    }
    if (box != tile.box) note(tile, "the tile's box is not that of its blocks");
    return {};
  }

  void check_cell(std::size_t t) {
    const TileInfo& tile = store_.tiles()[t];
    if (t == 0 || !store_.header().ordered) return;
    const Cell& previous = store_.tiles()[t - 1].cell;
    // Only one position may need several tiles.
    const bool shared = previous == tile.cell && tile.cell.level == kLatticeBits;
    if (!shared && tile.cell.first <= last_key(previous))
      note(tile, "the tile's cell overlaps the one before");
  }

  Result<void> check_block(const TileInfo& tile, const BlockInfo& block) {
    std::vector<Index3> positions(block.count);
    std::vector<std::byte> rows(block.count * row_size_);
    PSS_TRY(store_.read_positions(tile, block, positions));
    PSS_TRY(store_.read_rows(tile, block, rows));
    if (store_.header().ordered) check_order(tile, positions, rows);
    hash_.update(interleave(positions, rows, row_size_));
    ++summary_.blocks;
    summary_.points += block.count;
    return {};
  }

  void check_order(const TileInfo& tile, std::span<const Index3> positions,
                   std::span<const std::byte> rows) {
    bool inside = true;
    bool ordered = true;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      const Key key = encode_key(positions[i]);
      const std::byte* row = rows.data() + i * row_size_;
      inside = inside && contains(tile.cell, key);
      ordered = ordered && !(last_ && before(key, row, *last_, last_row_.data(), row_size_));
      last_ = key;
      last_row_.assign(row, row + row_size_);
    }
    if (!inside) note(tile, "a point lies outside the tile's cell");
    if (!ordered) note(tile, "the points are not in order");
  }

  const Store& store_;
  Monitor& monitor_;
  std::size_t row_size_;
  StreamHash hash_;
  VerifySummary summary_;
  std::optional<Key> last_;  ///< of the point before, and its row
  std::vector<std::byte> last_row_;
};

}  // namespace

Result<VerifySummary> verify_store(const std::string& path, MemoryBudget& budget,
                                   Monitor& monitor) {
  PSS_ASSIGN(Reservation memory, reserve_header(path, budget));
  PSS_ASSIGN(const Store store, Store::open(path));
  const std::uint64_t row = sizeof(Index3) + store.header().schema.row_size();
  const std::uint64_t needed =
      memory_of(store.header()) + store.table_memory() + 6 * kBlockPoints * row;
  if (!budget.grow(memory, needed))
    return budget.refusal(fmt::format("{}: verifying rows of {} bytes", path, row),
                          needed - memory.bytes());
  return Verifier(store, monitor).run();
}

Result<void> check_bytes(const std::string& path, Monitor& monitor) {
  PSS_ASSIGN(const Store store, Store::open(path));
  if (!store.complete())
    return Error{Fault::kBadInput, fmt::format("{}: the store is not complete", path)};
  for (std::size_t t = 0; t < store.tiles().size(); ++t) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
    PSS_TRY(store.check_bytes(t));
  }
  return check_inputs(store);
}

}  // namespace pss
