#include "io/formats/las/las_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "io/file/bytes.h"
#include "io/formats/las/las_crs.h"
#include "io/formats/las/las_format.h"
#include "io/formats/las/las_survey.h"

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
      : file_(std::move(file)), las_(las), header_(std::move(header)) {}

  const CloudHeader& header() const override { return header_; }

  Result<void> read(std::size_t max, PointBatch& batch) override {
    batch.clear();
    batch.first_record = next_;
    const std::size_t count = at_most(max);
    batch.index.resize(count);
    batch.rows.resize(count * row_size());
    const std::size_t step = std::max<std::size_t>(1, kChunkBytes / las_.record_length);
    for (std::size_t done = 0; done < count; done += step) {
      const std::size_t now = std::min(step, count - done);
      PSS_TRY(load(now, chunk_));
      decode(chunk_, std::span(batch.index).subspan(done, now),
             std::span(batch.rows).subspan(done * row_size(), now * row_size()));
    }
    return {};
  }

  Result<void> fetch(std::size_t max, RawPoints& out) override {
    out.points.first_record = next_;
    out.count = at_most(max);
    return load(out.count, out.bytes);
  }

  void decode(RawPoints& raw) const override {
    raw.points.index.resize(raw.count);
    raw.points.rows.resize(raw.count * row_size());
    decode(raw.bytes, raw.points.index, raw.points.rows);
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

  std::size_t at_most(std::size_t max) const {
    return static_cast<std::size_t>(std::min<std::uint64_t>(max, las_.points() - next_));
  }

  Result<void> load(std::size_t count, std::vector<std::byte>& records) {
    records.resize(count * las_.record_length);
    PSS_TRY(file_.read(las_.point_offset + next_ * las_.record_length, records));
    next_ += count;
    return {};
  }

  void decode(std::span<const std::byte> records, std::span<Index3> index,
              std::span<std::byte> rows) const {
    const std::size_t size = row_size();
    for (std::size_t i = 0; i < index.size(); ++i) {
      const auto record = records.subspan(i * las_.record_length, las_.record_length);
      for (std::size_t a = 0; a < 3; ++a) index[i][a] = load_le<std::int32_t>(record, 4 * a);
      std::memcpy(rows.data() + i * size, record.data() + kLasPositionSize, size);
    }
  }

  File file_;
  LasHeader las_;
  CloudHeader header_;
  std::uint64_t next_ = 0;
  std::vector<std::byte> chunk_;
};

}  // namespace

Result<std::unique_ptr<Reader>> open_las(const std::string& path) {
  return open_las_holding(HeadBytes::kKept, path);
}

Result<std::unique_ptr<Reader>> open_las_holding(HeadBytes bytes, const std::string& path) {
  PSS_ASSIGN(File file, File::open(path));
  PSS_ASSIGN(LasSurvey survey, survey_las(file));
  LasHead& head = survey.head;
  CloudHeader header;
  header.path = path;
  header.format = kLasFormat.name;
  header.count = head.header.points();
  header.grid = head.header.grid();
  header.bounds = bounds_of(head.header);
  header.schema = head.schema();
  header.warnings = std::move(head.warnings);
  header.crs = las_crs(head.vlrs(), head.bytes, survey.tail_crs);
  header.carry_size = survey.carry_size();
  if (bytes == HeadBytes::kKept) {
    PSS_ASSIGN(header.carry, read_las_carry(file, head.header, survey.tail_size));
  }
  return std::unique_ptr<Reader>(
      std::make_unique<LasReader>(std::move(file), head.header, std::move(header)));
}

}  // namespace pss
