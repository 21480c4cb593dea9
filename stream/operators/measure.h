#pragma once
// Measures something of each point's neighbourhood: columns of their own, and sums over the scan.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/fixed_sums.h"
#include "core/projector.h"
#include "core/surface_gate.h"
#include "stream/operators/part_tasks.h"
#include "stream/passes/operator.h"

namespace pss {

/// What was measured of one point.
struct Measurement {
  std::uint32_t value = 0;  ///< in the operator's quanta; kNothingMeasured where there is no value
  bool above = false;       ///< the point lies above the mean height of its neighbours
};
/// A value of its own, above all others. Also of points that are no neighbours of others.
inline constexpr std::uint32_t kNothingMeasured = 0xffffffff;

/// The columns of measurements, as a joined store has them.
inline constexpr const char* kValueColumn = "pss.Value";
inline constexpr const char* kAboveColumn = "pss.Above";
Schema measurement_schema();

/// Over all points that were measured.
struct MeasurementSums {
  FixedSums values;            ///< of points that have one
  std::uint64_t nothing = 0;   ///< points without a value
  std::uint64_t excluded = 0;  ///< points that are no neighbours of others: not looked at

  void add(const Measurement& measured, bool excluded);
  void add(const MeasurementSums& other);
  /// Of these bytes: another layout is another version.
  static constexpr std::uint32_t kVersion = 1;
  std::vector<std::byte> to_bytes() const;
  /// Bytes of another length give empty sums.
  static MeasurementSums from_bytes(std::span<const std::byte> bytes);
};

/// Measures every point of a source that is not excluded.
///
/// Rows: measurement_schema(), 5 bytes a point, to be joined to the source.
class MeasureOperator : public Operator {
 public:
  const StoreHeader& result_header() const override { return header_; }
  bool columns_alone() const override { return true; }
  const PartNeeds& needs() const override { return needs_; }
  const Neighbourhood& neighbourhood() const override { return neighbourhood_; }
  Rows apply(Part& part, Monitor& monitor) const override;
  std::uint32_t note_version() const override { return MeasurementSums::kVersion; }
  void merge_note(std::vector<std::byte>& total, std::span<const std::byte> next) const override;

  /// The world's units, or whatever the measurement has, of one step of a value.
  double quantum() const { return quantum_; }

 protected:
  /// `record`: JSON for the result's header.
  MeasureOperator(const Source& source, Neighbourhood neighbourhood, double quantum,
                  const std::string& record);

  /// Measures own points [first, first + out.size()), of which duplicates follow each other.
  virtual void measure(const Part& part, std::size_t first, std::span<Measurement> out) const = 0;

  /// The value of a measured number, at most what a column can hold.
  std::uint32_t in_quanta(double measured) const;

 private:
  MeasurementSums measure(const Slice& slice, Part& part) const;
  StoreHeader header_;
  PartNeeds needs_;
  Neighbourhood neighbourhood_;
  double quantum_;
};

/// The mean distance to the k nearest points, the point itself left out, duplicates counted.
/// Nothing where fewer than k lie within `cap`.
class MeanDistance : public MeasureOperator {
 public:
  /// Requires: k >= 1; cap and guess, a typical distance to the k-th nearest, above 0.
  MeanDistance(const Source& source, int k, double cap, double guess, const std::string& record);
  std::uint64_t scratch_bytes(std::uint64_t) const override { return 0; }
  bool gathers_neighbours() const override { return false; }

 private:
  void measure(const Part& part, std::size_t first, std::span<Measurement> out) const override;
  Measurement measure(const Part& part, std::size_t i) const;
  int k_;
  double cap_;
};

/// The number of points nearer than a radius, the point itself left out, duplicates counted.
class NeighbourCount : public MeasureOperator {
 public:
  NeighbourCount(const Source& source, double radius, const std::string& record);
  std::uint64_t scratch_bytes(std::uint64_t) const override { return 0; }
  bool gathers_neighbours() const override { return false; }

 private:
  void measure(const Part& part, std::size_t first, std::span<Measurement> out) const override;
  double radius_;
};

/// The residual of the fit at a point with its degrees of freedom (SurfaceGate), over h. Nothing
/// where the projection finds no surface.
class FitResidual : public MeasureOperator {
 public:
  FitResidual(const Source& source, const Method& method, const Support& support,
              const std::string& record);
  std::uint64_t scratch_bytes(std::uint64_t ball_points) const override;

 private:
  void measure(const Part& part, std::size_t first, std::span<Measurement> out) const override;
  Method method_;
  Support support_;
  SurfaceGate gate_;
};

}  // namespace pss
