#pragma once
// What a projection did to many points, in a form that tiles keep and reports add up.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/projection.h"
#include "core/result.h"
#include "stream/store/note.h"

namespace pss {

/// Sums over points. Adding blocks in row order gives the same bits however tiles were cut.
struct ProjectStatistics {
  std::array<std::uint64_t, kStatusCount> statuses{};
  std::uint64_t neighbours = 0;  ///< summed over the points that were evaluated
  std::uint64_t evaluated = 0;   ///< points with any neighbours counted
  std::uint64_t most_neighbours = 0;
  std::uint64_t second_sheet = 0;  ///< points with another sheet in their neighbourhood
  std::uint64_t redone = 0;        ///< points that single precision gave up, done in double
  double displacement_sq = 0;      ///< summed over the points that moved
  double largest_displacement = 0;
  double residual_sq = 0;  ///< summed over the points that moved

  void add(const Projection& projection);
  void add(const ProjectStatistics& other);

  std::uint64_t points() const;
  std::uint64_t moved() const;
  double mean_neighbours() const;
  /// Share of the evaluated points.
  double redone_share() const;
  double rms_displacement() const;
  double rms_residual() const;

  /// Of these bytes: another layout is another version.
  static constexpr std::uint32_t kVersion = 1;
  std::vector<std::byte> to_bytes() const;
  /// Bytes of another length give empty statistics.
  static ProjectStatistics from_bytes(std::span<const std::byte> bytes);
  /// Of `store` or a tile of it. Errors: kBadInput where another version of pss wrote its note.
  static Result<ProjectStatistics> from_note(const Note& note, const std::string& store);
};

}  // namespace pss
