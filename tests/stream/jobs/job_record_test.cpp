#include "stream/jobs/job_record.h"

#include <gtest/gtest.h>

#include <string>

#include "stream/jobs/json_text.h"
#include "tests/stream/store_fixture.h"

namespace pss {
namespace {

using test::expect_value;

JobRecord some_record() {
  JobRecord record;
  record.command = "smooth";
  record.output = "out put.las";
  record.sorting = R"({"tile-points":9})";
  record.parameters = R"({"knn":null,"radius":1.5})";
  record.inputs = {{"a.las", 10, 20, 30}, {"b.las", 11, 21, 31}};
  return record;
}

Result<JobRecord> read_again(const std::string& text) {
  return job_record_from("w/job.json", std::as_bytes(std::span(text)));
}

TEST(JobRecord, ComesBackWhole) {
  JobRecord record = some_record();
  record.complete = record.discarding = true;
  record.spoiled = "a.las has changed";
  record.passes = {"distances", "round-2"};
  record.may_grow = true;
  record.result = FileContent{5, -2, {18446744073709551615u, 7}};

  const JobRecord found = expect_value(read_again(to_text(record)));

  EXPECT_EQ(found.output, record.output);
  EXPECT_EQ(found.inputs, record.inputs);
  EXPECT_EQ(found.spoiled, record.spoiled);
  EXPECT_TRUE(found.complete && found.discarding);
  EXPECT_EQ(found.passes, record.passes);
  EXPECT_TRUE(found.may_grow);
  EXPECT_TRUE(same_bytes(*found.result, *record.result));
  EXPECT_EQ(found.result->modified_ns, -2);
  EXPECT_EQ(difference(found, record), "");
  EXPECT_EQ(identity_of(found), identity_of(record));
}

TEST(JobRecord, KeepsNamesOfAnyBytes) {
  for (const std::string& name :
       {std::string("caf\xE9.las"), std::string("100%.las"), std::string("%41"),
        std::string("\xFF"), std::string("na\xC3\xAFve.las"),
        std::string("new\nline \"quoted\"")}) {
    JobRecord record = some_record();
    record.output = record.inputs[0].path = name;

    const JobRecord found = expect_value(read_again(to_text(record)));

    EXPECT_EQ(found.output, name);
    EXPECT_EQ(difference(found, record), "") << name;
    EXPECT_EQ(name_of_json_text(json_text_of(name)), name);
  }
}

TEST(JobRecord, ThatIsNotWholeIsNone) {
  const std::string text = to_text(some_record());
  for (std::size_t at = 0; at < text.size(); ++at) {
    std::string changed = text;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    const auto found = read_again(changed);
    EXPECT_TRUE(!found || difference(*found, some_record()).empty()) << "byte " << at;
    const bool only_the_last_newline = at + 1 == text.size();
    EXPECT_TRUE(only_the_last_newline || !read_again(text.substr(0, at))) << "cut at " << at;
  }
}

TEST(JobRecord, OfAnotherVersionIsRefusedByName) {
  std::string text = to_text(some_record());
  const std::string version = "\"version\": 2";
  text.replace(text.find(version), version.size(), "\"version\": 3");
  // Its own checksum fits: that version wrote it.
  const auto refused = read_again(text);

  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().fault, Fault::kBadInput);
}

TEST(JobRecord, WhosePassesLeadOutOfTheDirectoryOrOntoOtherStoresIsNone) {
  for (const std::string name : {"../out", "a/b", "", ".", "input", "replaced", "A", "a.pss"}) {
    JobRecord record = some_record();
    record.passes = {"smooth", name};

    const auto found = read_again(to_text(record));

    ASSERT_FALSE(found) << name;
    EXPECT_EQ(found.error().fault, Fault::kBadInput);
  }
}

TEST(JobRecord, NamesTheFirstDifference) {
  const JobRecord then = some_record();
  const auto difference_by = [&](auto change) {
    JobRecord now = then;
    change(now);
    return difference(then, now);
  };

  EXPECT_EQ(difference_by([](JobRecord& r) { r.parameters = R"({"knn":null,"radius":2})"; }),
            "--radius was 1.5, is 2 now");
  EXPECT_EQ(difference_by([](JobRecord& r) { r.sorting = R"({"tile-points":8})"; }),
            "--tile-points was 9, is 8 now");
  EXPECT_EQ(difference_by([](JobRecord& r) { r.inputs[1].size = 12; }), "input b.las has changed");
  EXPECT_EQ(difference_by([](JobRecord& r) { r.inputs.pop_back(); }),
            "2 input files before, 1 now");
  EXPECT_EQ(difference_by([](JobRecord&) {}), "");
}

TEST(JobRecord, HasAnIdentityOfWhatTheResultDependsOn) {
  const JobRecord then = some_record();
  JobRecord later = then;
  later.complete = true;
  later.output = "elsewhere.las";
  JobRecord other = then;
  other.inputs[0].content_hash = 1;

  EXPECT_EQ(identity_of(later), identity_of(then));
  EXPECT_NE(identity_of(other), identity_of(then));
}

}  // namespace
}  // namespace pss
