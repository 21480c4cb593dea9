#pragma once
// Points on their way from a reader or to a writer, and what a file says of itself.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/lattice.h"
#include "io/points/schema.h"

namespace pss {

/// What of a file's header travels to a file of the same format, or family of formats, that is made
/// from it.
///
/// Opaque bytes that only the family's own readers and writers understand: for LAS the header and
/// VLRs (`head`) and the EVLRs (`tail`), for PLY the header text.
struct Carry {
  std::string family;  ///< Format::family; empty where nothing is carried
  std::vector<std::byte> head;
  std::vector<std::byte> tail;

  bool operator==(const Carry&) const = default;
};

/// What a file's header says, before any point is read. Nothing of it is trusted.
struct CloudHeader {
  std::string path;
  std::string format;                  ///< Format::name; empty for points of no file
  std::optional<std::uint64_t> count;  ///< points promised; text files promise none
  std::optional<Lattice> grid;         ///< the integer grid of positions, where the format has one
  std::optional<WorldBox> bounds;
  Schema schema;
  Carry carry;
  std::uint64_t carry_size = 0;  ///< bytes of `carry`, also where they were left in the file
  std::string crs;  ///< two files with different non-empty texts here do not go together
  std::vector<std::string> warnings;  ///< what was odd and read all the same
};

/// Consecutive points of one file.
///
/// Positions are in `index` where the header has a grid, otherwise in `world`; the other is empty.
struct PointBatch {
  std::uint64_t first_record = 0;
  std::vector<Index3> index;
  std::vector<World3> world;
  std::vector<std::byte> rows;  ///< size() * row_size bytes

  std::size_t size() const { return index.empty() ? world.size() : index.size(); }
  void clear() {
    index.clear();
    world.clear();
    rows.clear();
  }
};

/// Points on their way from a file: fetched, and perhaps not decoded yet.
struct RawPoints {
  PointBatch points;
  std::size_t count = 0;
  std::vector<std::byte> bytes;  ///< records as they lie in the file
};

}  // namespace pss
