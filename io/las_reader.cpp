#include "io/las_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "io/bytes.h"
#include "io/las_crs.h"
#include "io/las_file.h"

namespace pss {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

std::optional<WorldBox> bounds_of(const LasHeader& las) {
  const WorldBox box{las.min, las.max};
  for (std::size_t a = 0; a < 3; ++a)
    if (!std::isfinite(box.min[a]) || !std::isfinite(box.max[a]) || box.min[a] > box.max[a])
      return std::nullopt;
  return las.points() == 0 ? std::nullopt : std::optional(box);
}

class LasReader : public Reader {
 public:
  LasReader(File file, const LasHeader& las, CloudHeader header)
      : file_(std::move(file)), las_(las), header_(std::move(header)) {
    chunk_.reserve(std::max<std::size_t>(kChunkBytes, las.record_length));
  }

  const CloudHeader& header() const override { return header_; }

  Result<void> read(std::size_t max, PointBatch& batch) override {
    batch.clear();
    batch.first_record = next_;
    const std::uint64_t left = las_.points() - next_;
    const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(max, left));
    batch.index.resize(count);
    batch.rows.resize(count * row_size());
    const std::size_t step = std::max<std::size_t>(1, kChunkBytes / las_.record_length);
    for (std::size_t done = 0; done < count; done += step)
      PSS_TRY(read_chunk(done, std::min(step, count - done), batch));
    return {};
  }

  Result<void> seek(std::uint64_t record) override {
    if (record > las_.points())
      return Error{Fault::kBadInput, fmt::format("{}: found {} points, expected more than {}",
                                                 header_.path, las_.points(), record)};
    next_ = record;
    return {};
  }

 private:
  std::size_t row_size() const { return las_.record_length - kLasPositionSize; }

  Result<void> read_chunk(std::size_t at, std::size_t count, PointBatch& batch) {
    chunk_.resize(count * las_.record_length);
    PSS_TRY(file_.read(las_.point_offset + next_ * las_.record_length, chunk_));
    for (std::size_t i = 0; i < count; ++i) {
      const auto record = std::span(chunk_).subspan(i * las_.record_length, las_.record_length);
      for (std::size_t a = 0; a < 3; ++a)
        batch.index[at + i][a] = load_le<std::int32_t>(record, 4 * a);
      std::memcpy(batch.rows.data() + (at + i) * row_size(), record.data() + kLasPositionSize,
                  row_size());
    }
    next_ += count;
    return {};
  }

  File file_;
  LasHeader las_;
  CloudHeader header_;
  std::uint64_t next_ = 0;
  std::vector<std::byte> chunk_;
};

}  // namespace

Result<std::unique_ptr<Reader>> open_las(const std::string& path) {
  PSS_ASSIGN(File file, File::open(path));
  PSS_ASSIGN(LasHead head, read_las_head(file));
  CloudHeader header;
  header.path = path;
  header.format = Format::kLas;
  header.count = head.header.points();
  header.grid = head.header.grid();
  header.bounds = bounds_of(head.header);
  header.schema = head.schema();
  header.warnings = std::move(head.warnings);
  PSS_ASSIGN(header.carry.tail, read_las_tail(file, head.header, header.warnings));
  header.crs = las_crs(head.vlrs, head.bytes, list_evlrs(header.carry.tail), header.carry.tail);
  header.carry.format = Format::kLas;
  header.carry.head = std::move(head.bytes);
  return std::unique_ptr<Reader>(
      std::make_unique<LasReader>(std::move(file), head.header, std::move(header)));
}

}  // namespace pss
