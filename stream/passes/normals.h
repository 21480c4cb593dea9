#pragma once
// The normals of a source's points: which columns hold them, and how they are read.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/projector.h"
#include "core/result.h"
#include "stream/passes/source.h"

namespace pss {

/// What a first pass over the points puts before the names NormalX, NormalY, NormalZ.
inline constexpr const char* kComputedPrefix = "pss.";

/// Where a job finds the normals that its operator looks at.
enum class NormalsFrom : std::uint8_t {
  kNowhere,    ///< the operator needs none
  kInput,      ///< attributes of the input, oriented
  kFirstPass,  ///< computed by the job itself, any sign
};

/// "given", "computed"; empty for nowhere. And back: what is unknown is nowhere.
const char* name_of(NormalsFrom from);
NormalsFrom normals_named(std::string_view name);

/// Three columns of a source.
class NormalColumns {
 public:
  /// NormalX NormalY NormalZ, or nx ny nz as PLY files have them: all of floating point or scaled.
  static std::optional<NormalColumns> given(const Schema& schema);
  /// What a first pass over the points has added.
  static std::optional<NormalColumns> computed(const Schema& schema);

  /// Reads the normals of a block, of length one; zero where a point has none.
  ///
  /// Shape: `out` has block.count elements.
  /// Cost:  decodes these three columns alone.
  Result<void> read(const Source& source, std::size_t tile, const BlockInfo& block,
                    std::span<Normal> out) const;

 private:
  static std::optional<NormalColumns> find(const Schema& schema,
                                           const std::array<std::string, 3>& names);
  std::array<std::size_t, 3> fields_{};
};

/// Where an operator of a job over points of this schema finds normals.
NormalsFrom normals_from(const Schema& schema, const Method& method);

/// The schema without the columns of a first pass, where these are its last.
Schema without_computed_normals(const Schema& schema);

}  // namespace pss
