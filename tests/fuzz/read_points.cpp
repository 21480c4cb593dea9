#include "tests/fuzz/read_points.h"

#include <cstring>
#include <span>

#include "tests/fuzz/allocations.h"
#include "tests/fuzz/target.h"

namespace pss::test {
namespace {

void require_clear(const Error& error) {
  require(error.fault == Fault::kBadInput, "no damage, but: " + error.message);
  require(error.message.starts_with("/in: "), "does not name the file: " + error.message);
}

Result<PointBatch> rest_of(Reader& reader, std::size_t step) {
  PointBatch all;
  const std::size_t row = reader.header().schema.row_size();
  for (PointBatch batch;;) {
    PSS_TRY(reader.read(step, batch));
    require(batch.size() <= step, "more points than were asked for");
    require(batch.rows.size() == batch.size() * row, "rows of another size");
    if (batch.size() == 0) return all;
    all.index.insert(all.index.end(), batch.index.begin(), batch.index.end());
    all.world.insert(all.world.end(), batch.world.begin(), batch.world.end());
    all.rows.insert(all.rows.end(), batch.rows.begin(), batch.rows.end());
  }
}

template <class T>
void require_end(const std::vector<T>& whole, const std::vector<T>& end) {
  const std::size_t size = end.size() * sizeof(T);
  require(
      size == 0 || std::memcmp(whole.data() + (whole.size() - end.size()), end.data(), size) == 0,
      "other points after a seek");
}

/// Requires: all points were read.
void read_from_the_middle(Reader& reader, const PointBatch& all) {
  const Result<void> found = reader.seek(all.size() / 2);
  require(found.has_value(), "no way back to a point that was read");
  const Result<PointBatch> half = rest_of(reader, 100);
  require(half && half->size() == all.size() - all.size() / 2, "another number after a seek");
  require_end(all.index, half->index);
  require_end(all.world, half->world);
  require_end(all.rows, half->rows);
}

}  // namespace

void read_points(const std::uint8_t* data, std::size_t size,
                 Result<std::unique_ptr<Reader>> (*open)(const std::string& path)) {
  const OneFile file("/in", std::as_bytes(std::span(data, size)));
  const AllocationBound bound((4u << 20) + 64 * size);
  const Result<std::unique_ptr<Reader>> opened = open(file.path());
  if (!opened) return require_clear(opened.error());
  Reader& reader = **opened;
  const Result<PointBatch> all = rest_of(reader, 7);
  if (!all) return require_clear(all.error());
  require(!reader.header().count || *reader.header().count == all->size(),
          "another number of points than promised");
  read_from_the_middle(reader, *all);
}

}  // namespace pss::test
