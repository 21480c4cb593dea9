#pragma once
// The projection as an operator over tiles: support per point, new positions, outputs, statistics.

#include <cstdint>
#include <limits>
#include <optional>

#include "core/projector.h"
#include "stream/operators/part_tasks.h"
#include "stream/operators/project_statistics.h"
#include "stream/operators/query_batch.h"
#include "stream/passes/operator.h"
#include "stream/passes/outputs.h"

namespace pss {

/// What a projection computes; the choices of a user made definite.
struct ProjectParameters {
  Method method;
  Support support;         ///< of every query, unless `nearest` is set
  int nearest = 0;         ///< the query owns its support: `factor` * distance to its k-th nearest
  double factor = 1;       ///< radius / that distance; h follows from it and the method
  double cap = 0;          ///< a k-th nearest farther than this leaves the query isolated
  double first_guess = 0;  ///< a typical distance to the k-th nearest: what is loaded at first
  OutputSet outputs = 0;
  /// A first pass for operators that need normals: its rows are these alone, columns to be joined
  /// to the source, named with kComputedPrefix.
  bool only_normals = false;
  std::optional<Lattice> grid;  ///< the grid of the output file, whose int32 range limits places
  /// Halo width by hand. Where it is less than a support needs, that support is narrowed.
  std::optional<double> buffer;
  std::string record;  ///< JSON for the result's header: what made it; the source's where empty
};

/// The support itself where its reach is at most `width`, otherwise one that reaches just so far.
Support narrowed(const Support& support, WeightKind weight, double width);

/// The lattice of a result: the source's, its step refined up to 256-fold as far as 42 bits and
/// room for moves of `largest_move` allow.
Lattice refined_lattice(const Lattice& source, const IndexBox& bounds, double largest_move);

class ProjectOperator : public Operator {
 public:
  /// An operator that needs normals takes those of the source, given or computed; without any it
  /// can tell what parts take, and be applied to none.
  ///
  /// Errors: kUsage where an attribute of the source stands in the way of an output.
  static Result<ProjectOperator> create(const Source& source, const ProjectParameters& parameters);

  const StoreHeader& result_header() const override { return header_; }
  bool columns_alone() const override { return parameters_.only_normals; }
  const PartNeeds& needs() const override { return needs_; }
  const Neighbourhood& neighbourhood() const override { return neighbourhood_; }
  std::uint64_t scratch_bytes(std::uint64_t ball_points) const override;
  Rows apply(Part& part, Monitor& monitor) const override;
  std::uint32_t note_version() const override { return ProjectStatistics::kVersion; }
  void merge_note(std::vector<std::byte>& total, std::span<const std::byte> next) const override;

 private:
  /// A cell grid wants some width, also where no point looks around.
  static constexpr double kSmallestReach = std::numeric_limits<double>::min();

  /// What a thread computes a slice with.
  struct Worker {
    Worker(const CellGrid& grid, const Method& method, const CloudNormals& normals)
        : projector(grid, method, normals) {}
    Projector projector;
    QueryBatch batch;
  };
  ProjectStatistics project(const Slice& slice, Worker& worker, Part& part) const;
  static std::vector<std::vector<std::byte>> notes_of(
      const Part& part, const std::vector<Slice>& slices,
      const std::vector<ProjectStatistics>& statistics);

  ProjectOperator(const Source& source, const ProjectParameters& parameters);
  Neighbourhood chosen_neighbourhood() const;
  void choose_lattice(const Source& source);
  void choose_normals(const Schema& source);
  Result<void> choose_columns();
  /// The support of a point whose k-th neighbour lies at `distance`.
  Support support_at(double distance) const;
  /// The support of own point i; its radius is 0 where it has none.
  Support support_of(const Part& part, std::size_t i) const;
  std::size_t bytes_per_row() const { return header_.schema.row_size(); }
  /// Fills the batch with the own points [first, first + count).
  void fill(const Part& part, std::size_t first, std::size_t count, QueryBatch& batch) const;
  /// Writes the outcome of own point i: place, outputs. The status may change to not representable.
  void place(Projection& projection, Part& part, std::size_t i) const;
  /// Where own point i goes, on the result's lattice; it stays where the output cannot hold that.
  Index3 destination(Projection& projection, const Index3& own) const;
  bool representable(const Index3& index) const;

  ProjectParameters parameters_;
  Lattice source_lattice_;
  std::int64_t refinement_ = 1;
  StoreHeader header_;
  OutputColumns columns_;
  PartNeeds needs_;
  Neighbourhood neighbourhood_;
  bool oriented_ = false;  ///< the normals of the source
};

}  // namespace pss
