#include "io/points/announced_count.h"

#include <fmt/format.h>

#include <span>

namespace pss {

Result<void> AnnouncedCount::check(const std::string& path, std::size_t more) const {
  if (more <= announced_ - come_) return {};
  return Error{
      Fault::kBadInput,
      fmt::format("{}: found more points than the {} that were announced", path, announced_)};
}

Result<void> AnnouncedCount::correct(OutputFile& file, std::uint64_t offset) const {
  if (come_ == announced_) return {};
  const std::size_t width = fmt::formatted_size("{}", announced_);
  const std::string digits = fmt::format("{:>{}}", come_, width);
  return file.patch(offset, std::as_bytes(std::span(digits)));
}

}  // namespace pss
