// Every n-th call of a whole job failing, and a disk that fills up: reliability tests 4 and 5.

#include <cerrno>

#include "tests/faults/small_job.h"

namespace pss::test {
namespace {

struct Failing {
  const char* name;
  int code;
  bool (*applies)(Call);
  bool harmless;  ///< the call is made again, or goes on: nobody notices
};

bool any(Call) { return true; }
bool transfers(Call call) { return call == Call::kRead || call == Call::kWrite; }
bool restarts(Call call) {
  return transfers(call) || call == Call::kOpen || call == Call::kTruncate;
}
/// Never done again in silence. What a removal leaves is removed later: there the bytes decide. Of
/// a finished job it is noted that it cannot be remembered.
bool final(Call call, const std::string& where) {
  return changes(call) && call != Call::kRemoveFile && call != Call::kRemoveDirectory &&
         !where.starts_with("/state");
}

class FailAt : public testing::TestWithParam<Failing> {};

TEST_P(FailAt, AnyCallIsOneMessageWithThePathAndResumable) {
  const Failing& failing = GetParam();
  const SmoothJob job = small_job(MlsOperator::kApss);
  const Undisturbed whole(job);
  std::uint64_t failures = 0;
  bool reached = true;
  for (std::uint64_t n = 1; reached; n += stride(17)) {
    SCOPED_TRACE(fmt::format("{} at call {}", failing.name, n));
    SimulatedDisk disk;
    disk.put(kScan, wavy_sheet(kSheet));
    disk.put("/state/other", {});  // so that a failed sync of "/" is never about the state folder
    Call failed = Call::kStatus;
    std::string where;
    std::uint64_t seen = 0;
    disk.set_fault([&](Call call, const std::string& path) {
      if (!failing.applies(call) || ++seen != n) return 0;
      failed = call;
      where = path;
      return failing.code;
    });

    const auto report = run(job);

    reached = seen >= n;
    failures += !report;
    if (report) {
      ASSERT_TRUE(!reached || failing.harmless || !final(failed, where))
          << name_of(failed) << " " << where;
      ASSERT_TRUE(disk.content(kOut) == whole.result);
    } else {
      const auto& [fault, message] = report.error();
      ASSERT_FALSE(failing.harmless) << message;
      ASSERT_EQ(fault, Fault::kFailed) << message;
      ASSERT_EQ(message.find('\n'), std::string::npos) << message;
      ASSERT_TRUE(message.starts_with("/scan.ply") || message.starts_with("/out.ply") ||
                  message.starts_with("/: ") || message.starts_with("/.out.ply."))
          << message;
    }
    // What a failed sync left in memory may never have reached the disk.
    disk.restart(Crash::kForget, n);
    // A finished job that could not be remembered is refused another time, for its output is there.
    if (!report) expect_resumes(disk, job, whole);
    ASSERT_TRUE(disk.content(kOut) == whole.result);
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_EQ(failures == 0, failing.harmless);
}

INSTANTIATE_TEST_SUITE_P(Calls, FailAt,
                         testing::Values(Failing{"Eio", EIO, any, false},
                                         Failing{"Enospc", ENOSPC, changes, false},
                                         Failing{"Eintr", EINTR, restarts, true},
                                         Failing{"Short", kShort, transfers, true}),
                         [](const auto& param) { return param.param.name; });

TEST(FullDisk, AtAnySizeTheJobSaysSoAndFinishesWhenThereIsRoom) {
  const SmoothJob job = small_job(MlsOperator::kApss);
  const Undisturbed whole(job);
  const std::uint64_t scan = wavy_sheet(kSheet).size();
  const std::uint64_t step = (whole.largest_use - scan) / (2000 / stride(25));
  for (std::uint64_t capacity = scan; capacity < whole.largest_use; capacity += step) {
    SCOPED_TRACE(fmt::format("{} bytes", capacity));
    SimulatedDisk disk;
    disk.put(kScan, wavy_sheet(kSheet));
    disk.set_capacity(capacity);

    const auto report = run(job);

    ASSERT_FALSE(report);
    ASSERT_NE(report.error().message.find("No space left"), std::string::npos)
        << report.error().message;
    disk.restart(Crash::kKeep, 1);
    disk.set_capacity(std::uint64_t{1} << 40);
    expect_resumes(disk, job, whole);
    ASSERT_FALSE(HasFailure());
  }
}

}  // namespace
}  // namespace pss::test
