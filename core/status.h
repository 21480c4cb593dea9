#pragma once
// What became of a point: the codes that the Status attribute carries.

#include <cstdint>

namespace pss {

enum class Status : std::uint8_t {
  kOk = 0,
  kDegreeReduced = 1,     ///< moved, with the highest degree its neighbourhood determines
  kTooFew = 2,            ///< stays: fewer neighbours than a plane needs
  kDegenerate = 3,        ///< stays: no plane (identical, collinear, eigenvalue tie)
  kOutOfDomain = 4,       ///< stays: the foot point would lie more than h/2 away
  kIsolated = 5,          ///< stays: its neighbours lie beyond the cap
  kNotRepresentable = 6,  ///< stays: the output format cannot hold the new place
  kExcluded = 7,          ///< unchanged and no neighbour of others (withheld, noise classes)
};

inline constexpr int kStatusCount = 8;
/// Added to a status: another sheet lies within the neighbourhood.
inline constexpr std::uint8_t kSecondSheetFlag = 128;

/// The status's name in reports: "ok", "degree_reduced", ...
const char* status_name(Status status);

/// Whether a point with this status was moved.
constexpr bool moved(Status status) {
  return status == Status::kOk || status == Status::kDegreeReduced;
}

}  // namespace pss
