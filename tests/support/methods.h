#pragma once
// Every way to project, for parameterised tests.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/method.h"

namespace pss::test {

/// The methods of some operators: every weight, precision and, where it has a meaning, degree.
inline std::vector<Method> methods_of(const std::vector<MlsOperator>& operators,
                                      const std::vector<int>& degrees = {0, 1, 2, 3, 4}) {
  std::vector<Method> methods;
  for (const MlsOperator op : operators)
    for (const WeightKind weight : kWeightKinds)
      for (const Precision precision : {Precision::kDouble, Precision::kSingle})
        for (const int degree : needs_normals(op) ? std::vector{3} : degrees)
          methods.push_back({op, weight, precision, degree});
  return methods;
}

inline std::vector<Method> all_methods(const std::vector<int>& degrees = {0, 1, 2, 3, 4}) {
  return methods_of({kMlsOperators.begin(), kMlsOperators.end()}, degrees);
}

/// "levin_gaussian_double_3".
inline std::string name_of(const Method& m) {
  const std::string name = std::string(pss::name_of(m.op)) + "_" + pss::name_of(m.weight) + "_" +
                           pss::name_of(m.precision);
  return needs_normals(m.op) ? name : name + "_" + std::to_string(m.degree);
}

/// Names a case of a parameterised test.
inline std::string method_name(const testing::TestParamInfo<Method>& info) {
  return name_of(info.param);
}

}  // namespace pss::test
