#include "stream/jobs/smooth_method.h"

#include <gtest/gtest.h>

#include "stream/jobs/smooth.h"

namespace pss {
namespace {

TEST(SmoothMethod, TakesWhatIsSaidAndChoosesThePrecision) {
  SmoothOptions options;
  options.op = MlsOperator::kFast;
  options.weight = WeightKind::kPcl;
  options.widths.degree = 4;

  const Method method = method_of(options);

  EXPECT_EQ(method.op, MlsOperator::kFast);
  EXPECT_EQ(method.weight, WeightKind::kPcl);
  EXPECT_EQ(method.degree, 4);
  EXPECT_EQ(method.precision, Precision::kDouble) << "single is no choice for degree 4";
  options.precision = Precision::kSingle;
  EXPECT_EQ(method_of(options).precision, Precision::kSingle) << "unless asked for";
}

TEST(SmoothMethod, OfSpheresHasADegreeOfItsOwnWithTheSameRadius) {
  SmoothOptions options;
  options.op = MlsOperator::kApss;

  const Method method = method_of(options);
  const Method first = normals_method(method);

  EXPECT_EQ(method.degree, kNormalsDegree);
  EXPECT_EQ(radius_factor(method.degree), radius_factor(options.widths.degree));
  EXPECT_EQ(first.op, MlsOperator::kLevin);
  EXPECT_EQ(radius_factor(first.degree), radius_factor(method.degree));
  EXPECT_EQ(first.weight, method.weight);
}

}  // namespace
}  // namespace pss
