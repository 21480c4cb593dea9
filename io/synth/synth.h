#pragma once
// Reads a scan that is in no file: noisy samples of a known surface, made when asked for.

#include <memory>
#include <optional>

#include "io/points/reader.h"
#include "io/synth/synth_options.h"
#include "io/synth/synth_plan.h"

namespace pss {

/// A scan whose every record is a function of the options and the record's number.
///
/// Records carry what LAS point format 1 carries (0 without time, 6 above 2^32 - 1 points);
/// PointSourceId is the scan from 1 on, GpsTime counts microseconds.
class SynthReader final : public Reader {
 public:
  /// Errors: kUsage, as check(options) gives.
  static Result<std::unique_ptr<Reader>> create(const SynthOptions& options);

  const CloudHeader& header() const override { return header_; }
  /// Cost: 100 to 300 ns a point on one thread; runs on all.
  Result<void> read(std::size_t max, PointBatch& batch) override;
  Result<void> seek(std::uint64_t record) override;

 private:
  /// Where the attributes lie in a row.
  struct Columns {
    std::size_t intensity = 0, source = 0;
    std::optional<std::size_t> time, truth;
  };

  explicit SynthReader(const SynthOptions& options);
  void make_header();
  void make_template_row();
  void generate(std::uint64_t first, std::size_t begin, std::size_t end, PointBatch& batch) const;
  SurfacePoint sample(std::uint64_t record, const Place& place) const;
  void fill_row(std::uint64_t record, const World3& place, double distance, std::byte* row) const;

  SynthOptions options_;
  SynthPlan plan_;
  double sigma_ = 0;
  double jitter_ =
      0;  ///< times the spacing of a Place: the largest step to the side, along an axis
  CloudHeader header_;
  Columns columns_{};
  std::vector<std::byte> row_;  ///< what all rows share
  std::uint64_t next_ = 0;
};

}  // namespace pss
