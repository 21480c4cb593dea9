#include "io/formats/las/las_survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/file/file_window.h"
#include "io/file/hash.h"
#include "io/formats/las/las_crs.h"
#include "io/formats/las/las_evlrs.h"

namespace pss {
namespace {

constexpr std::size_t kWindow = std::size_t{64} << 10;
/// Extra bytes are described by one VLR, sometimes by a few; a hostile file has a million.
constexpr std::size_t kMostExtra = 3 * kWindow;
/// A longer WKT is none that anybody wrote: it is not understood, only told from others.
constexpr std::uint64_t kLongestWkt = std::uint64_t{64} << 10;

/// Collects the VLRs by which points are read and systems compared.
class Understood {
 public:
  bool wants(const VlrHeader& vlr) const {
    if (vlr.is("LASF_Spec", kExtraBytesRecord)) return extra_ < kMostExtra;
    const auto projection = std::ranges::find_if(
        kProjection, [&](std::uint16_t record) { return vlr.is("LASF_Projection", record); });
    return projection != kProjection.end() &&
           !has_[static_cast<std::size_t>(projection - kProjection.begin())];
  }

  void take(const VlrHeader& vlr, std::span<const std::byte> whole, std::vector<std::byte>& to) {
    for (std::size_t i = 0; i < kProjection.size(); ++i)
      has_[i] = has_[i] || vlr.is("LASF_Projection", kProjection[i]);
    if (vlr.is("LASF_Spec", kExtraBytesRecord)) extra_ += whole.size();
    to.insert(to.end(), whole.begin(), whole.end());
  }

 private:
  static constexpr std::array<std::uint16_t, 3> kProjection{kWktRecord, 34735, 34736};
  std::array<bool, 3> has_{};
  std::size_t extra_ = 0;
};

/// Adds the understood VLRs to the header block; returns how many lie whole before the points.
Result<std::uint32_t> add_understood(FileWindow& window, const LasHeader& header,
                                     std::vector<std::byte>& bytes) {
  Understood understood;
  std::uint64_t offset = header.header_size;
  for (std::uint32_t i = 0; i < header.vlr_count; ++i) {
    PSS_ASSIGN(const auto start, window.at(offset, kVlrHeader));
    if (start.empty()) return i;
    const VlrHeader vlr = load_vlr_header(start);
    const std::uint64_t size = kVlrHeader + vlr.length;
    if (offset + size > header.point_offset) return i;
    if (understood.wants(vlr)) {
      PSS_ASSIGN(const auto whole, window.at(offset, static_cast<std::size_t>(size)));
      understood.take(vlr, whole, bytes);
    }
    offset += size;
  }
  return header.vlr_count;
}

Result<LasHead> survey_head(const File& file, std::uint64_t size) {
  std::vector<std::byte> bytes(kLas14Header);
  PSS_ASSIGN(const std::size_t got, file.read_some(0, bytes));
  bytes.resize(got);
  PSS_ASSIGN(const LasHeader header, understood_las_header(bytes, file.path(), size));
  if (header.point_offset > kLasLargestCarry)
    return Error{
        Fault::kBadInput,
        fmt::format("{}: LAS header, offset 96: found {} bytes before the points, expected "
                    "at most {}",
                    file.path(), header.point_offset, kLasLargestCarry)};
  FileWindow window(file, header.point_offset, kWindow);
  PSS_ASSIGN(const auto block, window.at(0, header.header_size));
  bytes.assign(block.begin(), block.end());
  PSS_ASSIGN(const std::uint32_t vlrs, add_understood(window, header, bytes));
  return las_head(header, std::move(bytes), vlrs);
}

/// A name for a text of which only this is known.
Result<std::string> fingerprint_of_wkt(const File& file, std::uint64_t offset,
                                       std::uint64_t length) {
  FileWindow window(file, offset + length, kWindow);
  StreamHash hash;
  for (std::uint64_t done = 0; done < length;) {
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(kWindow, length - done));
    PSS_ASSIGN(const auto bytes, window.at(offset + done, step));
    hash.update(bytes);
    done += step;
  }
  return fmt::format("WKT of {} bytes, {}", length, to_string(hash.digest()));
}

Result<std::string> crs_at(const File& file, std::uint64_t offset, std::uint64_t length) {
  if (length > kLongestWkt) return fingerprint_of_wkt(file, offset, length);
  std::vector<std::byte> wkt(static_cast<std::size_t>(length));
  PSS_TRY(file.read(offset, wkt));
  return crs_of_wkt(wkt);
}

}  // namespace

Result<LasSurvey> survey_las(const File& file) {
  PSS_ASSIGN(const std::uint64_t size, file.size());
  LasSurvey survey;
  PSS_ASSIGN(survey.head, survey_head(file, size));
  std::vector<std::string>& warnings = survey.head.warnings;
  note_las_rest(survey.head.header, size, warnings);
  DropNotes dropped("EVLR");
  PSS_TRY(for_each_evlr(file, survey.head.header, [&](const Evlr& evlr) -> Result<void> {
    if (evlr.why_dropped) {
      dropped.add(evlr.header.user_id, evlr.header.record_id, evlr.why_dropped, warnings);
      return {};
    }
    survey.tail_size += evlr.size();
    if (survey.tail_crs || !evlr.header.is("LASF_Projection", kWktRecord)) return {};
    PSS_ASSIGN(survey.tail_crs, crs_at(file, evlr.offset + kEvlrHeader, evlr.header.length));
    return {};
  }));
  dropped.finish(warnings);
  return survey;
}

}  // namespace pss
