#include "stream/passes/outputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <sstream>
#include <utility>

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

constexpr const char* kPlyNormals[] = {"nx", "ny", "nz"};

/// Whether a program that does not tell capitals from small letters takes the names for one.
bool same_name(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

/// Whether an attribute of a scan is what an output stands for.
bool is_meant(const Attribute& attribute, std::string_view prefix, std::string_view name) {
  if (!prefix.empty()) return name == fmt::format("{}{}", prefix, attribute.name);
  if (same_name(name, attribute.name)) return true;
  return attribute.output == kNormals && same_name(name, kPlyNormals[attribute.part]);
}

/// The attribute of a set that has, or would have, this name; null where none has.
const Attribute* attribute_for(OutputSet set, std::string_view prefix, std::string_view name) {
  const auto* found = std::ranges::find_if(kAttributes, [&](const Attribute& attribute) {
    return (set & attribute.output) && is_meant(attribute, prefix, name);
  });
  return found == std::end(kAttributes) ? nullptr : found;
}

/// A few bits among others cannot be replaced by a value of another size.
Result<void> check_bits(const Field& field, OutputSet set, std::string_view prefix) {
  for (const BitField& bits : field.bits)
    if (attribute_for(set, prefix, bits.name))
      return Error{Fault::kUsage,
                   fmt::format("found the attribute {} in {} bits of {}, which --outputs cannot "
                               "replace; leave that output out",
                               bits.name, bits.width, field.name)};
  return {};
}

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
        return Error{Fault::kUsage, fmt::format("unknown word \"{}\"; known are {}, all, none",
                                                word, fmt::join(output_names(kAllOutputs), ", "))};
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

std::vector<OutputClash> clashes_of(const Schema& schema, OutputSet set) {
  std::vector<OutputClash> clashes;
  for (const Dimension& dimension : schema.dimensions())
    if (const Attribute* output = attribute_for(set, {}, dimension.name))
      clashes.push_back({dimension.name, output->name, output_names(output->output).front()});
  return clashes;
}

Result<OutputColumns> OutputColumns::add_to(Schema& schema, OutputSet set,
                                            std::string_view prefix) {
  OutputColumns columns;
  Schema result;
  std::array<bool, std::size(kAttributes)> placed{};
  const auto place = [&](const Attribute& attribute) {
    if (std::exchange(placed[static_cast<std::size_t>(&attribute - kAttributes)], true)) return;
    columns.columns_.push_back(
        {attribute.output, attribute.part, result.row_size(), attribute.type});
    result.add({fmt::format("{}{}", prefix, attribute.name), attribute.type, 1, 1, 0, {}});
  };
  for (std::size_t f = 0; f < schema.fields().size(); ++f) {
    const Field& field = schema.fields()[f];
    PSS_TRY(check_bits(field, set, prefix));
    const Attribute* replacing =
        field.bits.empty() ? attribute_for(set, prefix, field.name) : nullptr;
    if (replacing) {
      place(*replacing);
      continue;
    }
    columns.keep({schema.position(f), result.row_size(), field.size()});
    result.add(field);
  }
  for (const Attribute& attribute : kAttributes)
    if (set & attribute.output) place(attribute);
  schema = std::move(result);
  return columns;
}

void OutputColumns::keep(const KeptBytes& bytes) {
  KeptBytes* last = kept_.empty() ? nullptr : &kept_.back();
  if (last && last->from + last->size == bytes.from && last->to + last->size == bytes.to)
    last->size += bytes.size;
  else
    kept_.push_back(bytes);
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
