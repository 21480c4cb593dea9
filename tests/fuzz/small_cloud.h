#pragma once
// A few points with every kind of field, for the seeds of targets that read what pss wrote.

#include <cstddef>
#include <vector>

#include "core/morton.h"
#include "stream/store/block.h"

namespace pss::test {

inline Schema small_schema() {
  return Schema({{"Intensity", Type::kUint16, 1, 1, 0, {}},
                 {"Flags", Type::kUint8, 1, 1, 0, {{"ReturnNumber", 0, 3}, {"Withheld", 7, 1}}},
                 {"GpsTime", Type::kFloat64, 1, 1, 0, {}},
                 {"Extra", Type::kInt32, 3, 0.5, 2, {}}});
}

/// Points (i, 0, 0) from `first` on, which is their order by key.
inline std::vector<Index3> small_positions(std::size_t count, std::int64_t first = 0) {
  std::vector<Index3> positions;
  for (std::size_t i = 0; i < count; ++i)
    positions.push_back({first + static_cast<std::int64_t>(i), 0, 0});
  return positions;
}

inline std::vector<std::byte> small_rows(std::size_t count, const Schema& schema) {
  std::vector<std::byte> rows(count * schema.row_size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<std::byte>(i * 7 & 0x3F);
  return rows;
}

}  // namespace pss::test
