#pragma once
// Keeps, drops or classifies the points of a source by what was measured of them.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/result.h"
#include "stream/operators/measure.h"
#include "stream/operators/selection_counts.h"
#include "stream/passes/operator.h"

namespace pss {

/// Which points are outliers, and what becomes of them.
struct Selection {
  std::uint32_t least = 0;  ///< values from `least` to `most` are those of points that stay
  std::uint32_t most = kNothingMeasured - 1;
  bool classify = false;  ///< outliers stay, with another class
  std::uint8_t low = 7;   ///< the class of outliers
  std::uint8_t high = 7;  ///< of those that lie above their neighbours
  std::string output;     ///< the attribute that gets the measured value; empty: none
  double quantum = 1;     ///< of that value; -1 where nothing was measured
  std::string record;     ///< JSON for the result's header
};

/// The source's schema without measurements, with what a selection adds: Classification where it
/// classifies and there is none, and its output.
///
/// Errors: kUsage where the source has an attribute of the output's name, or where its
///         Classification cannot hold the classes.
Result<Schema> selected_schema(const Schema& source, const Selection& selection);

class SelectOperator : public Operator {
 public:
  /// Requires: measurements are joined to the source, last.
  /// Errors:   those of selected_schema().
  static Result<SelectOperator> create(const Source& source, const Selection& selection);

  const StoreHeader& result_header() const override { return header_; }
  const PartNeeds& needs() const override { return needs_; }
  const Neighbourhood& neighbourhood() const override { return neighbourhood_; }
  std::uint64_t scratch_bytes(std::uint64_t) const override { return 0; }
  Rows apply(Part& part, Monitor& monitor) const override;
  std::uint32_t note_version() const override { return SelectionCounts::kVersion; }
  void merge_note(std::vector<std::byte>& total, std::span<const std::byte> next) const override;

 private:
  SelectOperator(const Source& source, const Selection& selection);
  Measurement measured(const std::byte* row) const;
  bool inside(const Measurement& measured) const;
  void complete(const Measurement& measured, bool outlier, std::byte* row) const;
  Selection selection_;
  StoreHeader header_;
  PartNeeds needs_;
  Neighbourhood neighbourhood_;  ///< nothing
  std::size_t measured_at_ = 0;  ///< where measurements lie in a part's row
  std::optional<Dimension> class_;
  std::optional<Dimension> output_;
};

}  // namespace pss
