#pragma once
// How many points a writer was told to expect: what it does where others come.

#include <cstddef>
#include <cstdint>
#include <string>

#include "core/result.h"
#include "io/file/output_file.h"

namespace pss {

/// Counts the points of one file against those announced.
class AnnouncedCount {
 public:
  explicit AnnouncedCount(std::uint64_t announced) : announced_(announced) {}

  std::uint64_t announced() const { return announced_; }
  std::uint64_t come() const { return come_; }

  /// Whether so many more may come. Errors: kBadInput where they are too many.
  Result<void> check(const std::string& path, std::size_t more) const;
  void add(std::size_t points) { come_ += points; }

  /// Puts the points that came over the announced ones, which are text at `offset`, where they are
  /// fewer: set right behind blanks, which every reader of headers skips.
  Result<void> correct(OutputFile& file, std::uint64_t offset) const;

 private:
  std::uint64_t announced_;
  std::uint64_t come_ = 0;
};

}  // namespace pss
