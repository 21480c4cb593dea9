#pragma once
// What became of the points that were read, in words.

#include <string>
#include <vector>

#include "stream/sort/ingest.h"

namespace pss {

/// A line for each reason that points were dropped for, and one for those that were rounded.
std::vector<std::string> ingest_lines(const IngestSummary& summary);

}  // namespace pss
