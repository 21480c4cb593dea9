#include "stream/store/export.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/formats/table.h"
#include "io/inputs.h"
#include "io/open.h"
#include "io/points/integer_grid.h"

namespace pss {
namespace {

Result<WriteOptions> write_options(const Store& store, const Format& format,
                                   const ExportOptions& options) {
  const StoreHeader& header = store.header();
  WriteOptions write;
  write.schema = header.schema;
  write.grid = header.lattice;
  write.count = store.points();
  PSS_ASSIGN(write.carry, carried_head(store, format));
  write.bounds = world_bounds_of(store);
  write.rules = options.rules;
  // Positions that came as floating point are known to half a step of their lattice.
  if (!header.grid) write.tolerance = 0.499 * *std::ranges::min_element(header.lattice.scale);
  if (format.integer_grid) {
    const Lattice grid = export_grid(header, *write.bounds, 0, options);
    write.scale = grid.scale;
    write.offset = grid.origin;
  }
  return write;
}

/// Copies one block of a store to a writer.
Result<void> write_block(const Store& store, const TileInfo& tile, const BlockInfo& block,
                         PointBatch& batch, Writer& writer) {
  batch.first_record = block.first_row;
  batch.index.resize(block.count);
  batch.rows.resize(block.count * store.header().schema.row_size());
  PSS_TRY(store.read_positions(tile, block, batch.index));
  PSS_TRY(store.read_rows(tile, block, batch.rows));
  return writer.write(batch);
}

}  // namespace

IndexBox bounds_of(const Store& store) {
  IndexBox bounds;
  for (const TileInfo& tile : store.tiles()) bounds.add(tile.box);
  return bounds;
}

WorldBox world_bounds_of(const Store& store) {
  const IndexBox bounds = bounds_of(store);
  WorldBox world;
  if (bounds.empty()) return world;
  world.add(to_world(store.header().lattice, bounds.min));
  world.add(to_world(store.header().lattice, bounds.max));
  return world;
}

bool chooses_scale(const StoreHeader& header, const ExportOptions& options) {
  return !options.scale && (options.scale_auto || !header.grid);
}

Lattice export_grid(const StoreHeader& header, const WorldBox& bounds, double margin,
                    const ExportOptions& options) {
  Lattice grid =
      header.grid && !options.scale_auto ? *header.grid : integer_grid_with_room(bounds, margin);
  if (options.scale) grid.scale = *options.scale;
  if (options.offset) grid.origin = *options.offset;
  return grid;
}

Result<std::optional<Carry>> carried_head(const InputTable& inputs, const Format& format) {
  PSS_ASSIGN(const InputFacts facts, inputs.facts(0));
  const Format* first = find_format(facts.format);
  return first && first->family == format.family ? inputs.head(0) : std::optional<Carry>();
}

Result<std::optional<Carry>> carried_head(const Store& store, const Format& format) {
  if (store.header().inputs.count == 0) return std::optional<Carry>();
  PSS_ASSIGN(const InputTable inputs, store.inputs());
  return carried_head(inputs, format);
}

std::uint64_t export_memory(std::size_t row_size, std::uint64_t points) {
  return 4 * std::min<std::uint64_t>(points, kBlockPoints) * (64 + 2 * row_size);
}

Result<ExportSummary> export_store(const Store& store, const std::string& output,
                                   const ExportOptions& options, MemoryBudget& budget,
                                   Monitor& monitor) {
  if (!store.complete())
    return Error{Fault::kBadInput,
                 fmt::format("{}: the store is not complete; run the command that makes it again",
                             store.path())};
  const std::size_t row = store.header().schema.row_size();
  PSS_ASSIGN(const Reservation memory,
             budget.take(export_memory(row, store.points()),
                         fmt::format("{}: writing rows of {} bytes", store.path(), row)));
  PSS_TRY(check_output(std::array{store.path()}, output));
  PSS_ASSIGN(const Format* format, format_for(output));
  PSS_TRY(check_grid_options(output, format, options.scale || options.scale_auto,
                             options.offset.has_value()));
  std::string note;
  if (!options.checked) {
    PSS_ASSIGN(note, check_export(store, 0, *format, options, monitor));
  }
  PSS_ASSIGN(WriteOptions write, write_options(store, *format, options));
  PSS_ASSIGN(const std::unique_ptr<Writer> writer, create_writer(output, std::move(write)));
  monitor.begin("write", store.points(), store.tiles().size());
  PointBatch batch;
  for (std::size_t t = 0; t < store.tiles().size(); ++t) {
    PSS_ASSIGN(const std::vector<BlockInfo> index, store.read_index(t));
    for (const BlockInfo& block : index) {
      if (monitor.stopping()) return Error{Fault::kInterrupted, "interrupted"};
      PSS_TRY(write_block(store, store.tiles()[t], block, batch, *writer));
      monitor.advance(block.count);
    }
    monitor.advance(0, 1);
  }
  PSS_TRY(writer->finish());
  ExportSummary summary{store.points(), writer->grid(), writer->notes()};
  if (!note.empty()) summary.notes.push_back(std::move(note));
  return summary;
}

}  // namespace pss
