#pragma once
// Whether files are in one coordinate reference system, so that their points go together.

#include <string>

#include "core/result.h"
#include "io/points/points.h"

namespace pss {

/// The coordinate reference system of files that are read together, found one header at a time.
class CommonCrs {
 public:
  /// Takes the next file's header in. One without a system goes with any other.
  ///
  /// Errors: kBadInput where the file and one before it have different systems, with both names.
  Result<void> add(const CloudHeader& header);

 private:
  std::string path_;  ///< of the file that the text is from
  std::string text_;
};

}  // namespace pss
