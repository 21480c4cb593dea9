#include "io/formats/ply/ply_header.h"

#include <gtest/gtest.h>

#include <string>

namespace pss::test {
namespace {

const std::string kPath = "cloud.ply";
constexpr const char* kVertex =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";

std::string with_body(const std::string& body) {
  return "ply\nformat ascii 1.0\n" + body + "end_header\n";
}

void expect_refused(const std::string& head, const std::string& words) {
  const auto header = parse_ply_header(head, kPath);
  ASSERT_FALSE(header.has_value()) << head.substr(0, 200);
  EXPECT_EQ(header.error().fault, Fault::kBadInput);
  EXPECT_NE(header.error().message.find(kPath), std::string::npos) << header.error().message;
  EXPECT_NE(header.error().message.find(words), std::string::npos) << header.error().message;
}

TEST(PlyHeader, NamesElementsPropertiesAndTheirTypes) {
  const std::string head =
      "ply\nformat binary_big_endian 1.0\nelement face 7\nproperty list uchar int32 ids\n"
      "element vertex 12\nproperty double x\nproperty uint8 red\nend_header\nDATA";

  const auto header = parse_ply_header(head, kPath);

  ASSERT_TRUE(header.has_value()) << header.error().message;
  EXPECT_EQ(header->encoding, PlyEncoding::kBigEndian);
  EXPECT_EQ(header->size, head.size() - 4);
  EXPECT_EQ(header->lines, 8u);
  ASSERT_EQ(header->elements.size(), 2u);
  EXPECT_EQ(header->elements[0].count, 7u);
  EXPECT_EQ(header->elements[0].properties[0].length_type, Type::kUint8);
  EXPECT_EQ(header->elements[0].properties[0].type, Type::kInt32);
  EXPECT_EQ(header->elements[1].properties[0].type, Type::kFloat64);
  EXPECT_EQ(header->elements[1].properties[1].name, "red");
  EXPECT_EQ(header->elements[1].properties[1].spelling, "uint8");
}

TEST(PlyHeader, KeepsCommentsAndObjInfoInOrder) {
  const auto header = parse_ply_header(
      with_body(std::string("comment made by hand\nobj_info num_cols 5\n") + kVertex), kPath);

  ASSERT_TRUE(header.has_value()) << header.error().message;
  EXPECT_EQ(header->comments,
            (std::vector<std::string>{"comment made by hand", "obj_info num_cols 5"}));
}

TEST(PlyHeader, FormatsToTheTextItWasReadFrom) {
  const std::string head =
      "ply\nformat binary_little_endian 1.0\ncomment c\nelement vertex 3\nproperty float32 x\n"
      "property list uchar uint ids\nend_header\n";

  const auto header = parse_ply_header(head, kPath);

  ASSERT_TRUE(header.has_value()) << header.error().message;
  EXPECT_EQ(format_ply_header(*header), head);
}

TEST(PlyHeader, EndsItsLinesInAnyWay) {
  const std::string lines = with_body(kVertex);
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string head;
    for (const char c : lines) head += c == '\n' ? end : std::string(1, c);

    const auto header = parse_ply_header(head + "123", kPath);

    ASSERT_TRUE(header.has_value()) << header.error().message;
    EXPECT_EQ(header->size, head.size());
    EXPECT_EQ(header->elements[0].properties.size(), 3u);
  }
}

TEST(PlyHeader, TakesNoByteOfTheDataAsAnEndOfLine) {
  std::string head = with_body(kVertex);
  for (char& c : head)
    if (c == '\n') c = '\r';

  const auto header = parse_ply_header(head + "\n23", kPath);

  ASSERT_TRUE(header.has_value()) << header.error().message;
  EXPECT_EQ(header->size, head.size());
}

TEST(PlyHeader, RefusesWhatItCannotMean) {
  expect_refused("", "end_header");
  expect_refused("solid cube\nend_header\n", "expected 'ply'");
  expect_refused("ply\nend_header\n", "format");
  expect_refused("ply\nformat ascii 2.0\nend_header\n", "'2.0'");
  expect_refused("ply\nformat utf8 1.0\nend_header\n", "'utf8'");
  expect_refused(with_body("elephant vertex 3\n"), "'elephant'");
  expect_refused(with_body("property float x\n"), "before the first element");
  expect_refused(with_body("element vertex\n"), "count");
  expect_refused(with_body("element vertex -1\n"), "'-1'");
  expect_refused(with_body("element vertex 1e3\n"), "'1e3'");
  expect_refused(with_body("element vertex 18446744073709551616\n"), "2^64 - 1");
  expect_refused(with_body("element v 1\nelement v 1\n"), "twice");
  expect_refused(with_body("element vertex 1\nproperty float x\nproperty int x\n"), "twice");
  expect_refused(with_body("element vertex 1\nproperty quad x\n"), "'quad'");
  expect_refused(with_body("element vertex 1\nproperty float\n"), "name");
  expect_refused(with_body("element vertex 1\nproperty list float int x\n"), "length");
}

TEST(PlyHeader, RefusesHeadersWithoutBound) {
  std::string many = "element vertex 1\n";
  for (int i = 0; i < 5000; ++i) many += "property char p" + std::to_string(i) + "\n";
  std::string elements;
  for (int i = 0; i < 5000; ++i) elements += "element e" + std::to_string(i) + " 0\n";

  expect_refused(with_body(many), "1000 properties");
  expect_refused(with_body(elements), "1000 elements");
  expect_refused(std::string(kPlyHeaderLimit + 100, 'a'), "end_header");
  expect_refused(
      "ply\nformat ascii 1.0\ncomment " + std::string(kPlyHeaderLimit, 'a') + "\nend_header\n",
      "end_header");
}

}  // namespace
}  // namespace pss::test
