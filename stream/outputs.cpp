#include "stream/outputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>

namespace pss {
namespace {

struct Word {
  const char* name;
  Output output;
};

constexpr Word kWords[] = {
    {"normals", kNormals},           {"curvature", kCurvature}, {"principal", kPrincipal},
    {"displacement", kDisplacement}, {"residual", kResidual},   {"neighbors", kNeighbors},
    {"boundary", kBoundary},         {"status", kStatus},
};

struct Attribute {
  const char* name;
  Output output;
  int part;
  Type type;
};

constexpr Attribute kAttributes[] = {
    {"NormalX", kNormals, 0, Type::kFloat32},
    {"NormalY", kNormals, 1, Type::kFloat32},
    {"NormalZ", kNormals, 2, Type::kFloat32},
    {"MeanCurvature", kCurvature, 0, Type::kFloat32},
    {"GaussianCurvature", kCurvature, 1, Type::kFloat32},
    {"PrincipalCurvature1", kPrincipal, 0, Type::kFloat32},
    {"PrincipalCurvature2", kPrincipal, 1, Type::kFloat32},
    {"PrincipalDirection1X", kPrincipal, 2, Type::kFloat32},
    {"PrincipalDirection1Y", kPrincipal, 3, Type::kFloat32},
    {"PrincipalDirection1Z", kPrincipal, 4, Type::kFloat32},
    {"Displacement", kDisplacement, 0, Type::kFloat32},
    {"Residual", kResidual, 0, Type::kFloat32},
    {"Neighbors", kNeighbors, 0, Type::kUint32},
    {"Boundary", kBoundary, 0, Type::kFloat32},
    {"Status", kStatus, 0, Type::kUint8},
};

/// k1, k2, then the direction of k1: k1 >= k2 are H +- sqrt(H^2 - K).
double principal_value(const Projection& p, int part) {
  if (part >= 2) return p.principal_direction[static_cast<std::size_t>(part - 2)];
  const double h = p.mean_curvature;
  const double away = std::sqrt(std::max(0.0, h * h - p.gaussian_curvature));
  return part == 0 ? h + away : h - away;
}

double real_value(const Projection& p, Output output, int part) {
  const World3& d = p.displacement;
  switch (output) {
    case kNormals:
      return p.normal[static_cast<std::size_t>(part)];
    case kCurvature:
      return part == 0 ? p.mean_curvature : p.gaussian_curvature;
    case kPrincipal:
      return principal_value(p, part);
    case kDisplacement:
      return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    case kResidual:
      return p.residual;
    default:
      return p.boundary;
  }
}

}  // namespace

std::uint8_t status_value(const Projection& projection) {
  const auto status = static_cast<std::uint8_t>(projection.status);
  return projection.second_sheet ? status | kSecondSheetFlag : status;
}

Result<OutputSet> parse_outputs(const std::string& list) {
  OutputSet set = 0;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    if (word == "all")
      set |= kAllOutputs;
    else if (word != "none") {
      OutputSet found = 0;
      for (const Word& known : kWords)
        if (word == known.name) found = known.output;
      if (!found)
        return Error{Fault::kUsage,
                     fmt::format("--outputs: unknown word \"{}\"; known are {}, all, none", word,
                                 fmt::join(output_names(kAllOutputs), ", "))};
      set |= found;
    }
  }
  return set;
}

std::vector<std::string> output_names(OutputSet set) {
  std::vector<std::string> names;
  for (const Word& word : kWords)
    if (set & word.output) names.emplace_back(word.name);
  return names;
}

Result<OutputColumns> OutputColumns::add_to(Schema& schema, OutputSet set,
                                            std::string_view prefix) {
  OutputColumns columns;
  for (const Attribute& attribute : kAttributes) {
    if (!(set & attribute.output)) continue;
    const std::string name = fmt::format("{}{}", prefix, attribute.name);
    const std::optional<std::size_t> there = schema.find(name);
    if (!there) schema.add({name, attribute.type, 1, 1, 0, {}});
    const std::size_t field = there.value_or(schema.fields().size() - 1);
    const Field& column = schema.fields()[field];
    if (column.type != attribute.type || column.count != 1)
      return Error{Fault::kUsage,
                   fmt::format("the input has an attribute {} of type {}, expected {} to write "
                               "--outputs into; rename it or leave that output out",
                               name, type_name(column.type), type_name(attribute.type))};
    columns.columns_.push_back(
        {attribute.output, attribute.part, schema.position(field), attribute.type});
  }
  return columns;
}

void OutputColumns::write(const Projection& projection, std::byte* row) const {
  for (const Column& column : columns_) {
    std::byte* to = row + column.position;
    if (column.type == Type::kUint8) {
      *to = static_cast<std::byte>(status_value(projection));
    } else if (column.type == Type::kUint32) {
      std::memcpy(to, &projection.neighbours, sizeof projection.neighbours);
    } else {
      const auto value = static_cast<float>(real_value(projection, column.output, column.part));
      std::memcpy(to, &value, sizeof value);
    }
  }
}

}  // namespace pss
