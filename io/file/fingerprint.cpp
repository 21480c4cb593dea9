#include "io/file/fingerprint.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "io/file/file.h"
#include "io/file/hash.h"

namespace pss {
namespace {

using std::chrono::nanoseconds;

constexpr std::uint64_t kEndBytes = 64 * 1024;
/// The kernel stamps files with a clock that moves 100 times a second or more often.
constexpr nanoseconds kKernelStep = std::chrono::milliseconds(20);
/// Of file systems that keep whole or even seconds (ext3, HFS+, FAT).
constexpr nanoseconds kSecondsStep = std::chrono::seconds(2);

/// How long after a change another one may get the same time.
nanoseconds step_of(nanoseconds modified) {
  return modified % std::chrono::seconds(1) == nanoseconds(0) ? kSecondsStep : kKernelStep;
}

/// How long to wait until every change gets a later time than this one.
nanoseconds until_settled(std::int64_t modified_ns) {
  const nanoseconds modified(modified_ns);
  const nanoseconds now = std::chrono::system_clock::now().time_since_epoch();
  // A time that lies ahead was set by hand, or by a clock that this one knows nothing of.
  if (now < modified || modified < now - kSecondsStep) return nanoseconds(0);
  return std::max(nanoseconds(0), step_of(modified) - (now - modified));
}

std::string described(const InputRecord& record) {
  const nanoseconds modified(record.modified_ns);
  const auto seconds = std::chrono::floor<std::chrono::seconds>(modified);
  return fmt::format("{} bytes, last changed {:%Y-%m-%d %H:%M:%S}.{:09} UTC", record.size,
                     fmt::gmtime(static_cast<std::time_t>(seconds.count())),
                     (modified - seconds).count());
}

Error changed(const InputRecord& found, const InputRecord& expected) {
  const bool ends_differ = found.size == expected.size && found.modified_ns == expected.modified_ns;
  return {
      Fault::kFailed,
      fmt::format("{}: changed while it was read: found {}{}, expected {}; nothing was written; "
                  "run the command again once it is no longer written to",
                  expected.path, described(found),
                  ends_differ ? ", with other bytes at its ends" : "", described(expected))};
}

/// A file that has gone, or that the disk no longer gives.
Error unreadable(const Error& found, const InputRecord& expected) {
  return {
      Fault::kFailed,
      fmt::format("{}; expected {}, as before it was read; nothing was written; run the command "
                  "again once it can be read",
                  found.message, described(expected))};
}

}  // namespace

Result<InputRecord> fingerprint(const std::string& path) {
  PSS_ASSIGN(const File file, File::open(path));
  PSS_ASSIGN(const FileState state, file.state());
  InputRecord record;
  record.path = path;
  record.size = state.size;
  record.modified_ns = state.modified_ns;
  std::vector<std::byte> ends(2 * kEndBytes);
  const std::uint64_t last = record.size - std::min(record.size, kEndBytes);
  PSS_ASSIGN(const std::size_t head,
             file.read_some(0, std::span(ends).first(static_cast<std::size_t>(kEndBytes))));
  PSS_ASSIGN(
      const std::size_t tail,
      file.read_some(last, std::span(ends).subspan(head, static_cast<std::size_t>(kEndBytes))));
  record.content_hash = hash64(std::span(ends).first(head + tail));
  return record;
}

Result<InputRecord> settled_fingerprint(const std::string& path) {
  PSS_ASSIGN(const InputRecord first, fingerprint(path));
  const nanoseconds wait = until_settled(first.modified_ns);
  if (wait == nanoseconds(0)) return first;
  std::this_thread::sleep_for(wait);
  PSS_TRY(check_unchanged(first));
  return first;
}

Result<void> check_unchanged(const InputRecord& expected) {
  const Result<InputRecord> found = fingerprint(expected.path);
  if (!found) return unreadable(found.error(), expected);
  if (*found == expected) return {};
  return changed(*found, expected);
}

Result<void> check_unchanged(std::span<const InputRecord> expected) {
  for (const InputRecord& record : expected) PSS_TRY(check_unchanged(record));
  return {};
}

Error change_or(Error error, const InputRecord& expected) {
  Result<void> unchanged = check_unchanged(expected);
  return unchanged ? std::move(error) : std::move(unchanged).error();
}

}  // namespace pss
