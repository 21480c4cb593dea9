#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "io/synth/measure.h"

namespace pss {
namespace {

using Json = nlohmann::ordered_json;

Json lengths(const Magnitudes& m, double unit) {
  return {{"rms", m.rms() / unit},
          {"mean", m.mean() / unit},
          {"p50", m.percentile(0.5) / unit},
          {"p95", m.percentile(0.95) / unit},
          {"p99", m.percentile(0.99) / unit},
          {"max", m.max() / unit}};
}

Json errors(const Magnitudes& m) {
  Json json{{"count", m.count()}};
  json.update(lengths(m, 1));
  return json;
}

std::string row(std::string_view name, const Magnitudes& m, double unit) {
  return fmt::format("{:<34}{:>12.4g}{:>12.4g}{:>12.4g}{:>12.4g}{:>12.4g}{:>12.4g}\n", name,
                     m.rms() / unit, m.mean() / unit, m.percentile(0.5) / unit,
                     m.percentile(0.95) / unit, m.percentile(0.99) / unit, m.max() / unit);
}

}  // namespace

std::string measurement_json(const Measurement& measurement, const SynthOptions& truth) {
  Json json{{"points", measurement.distance.count()},
            {"not_finite", measurement.not_finite},
            {"spacing", spacing(truth)},
            {"distance", lengths(measurement.distance, 1)},
            {"distance_in_spacings", lengths(measurement.distance, spacing(truth))}};
  if (measurement.normal) json["normal"] = errors(*measurement.normal);
  if (measurement.mean_curvature) json["mean_curvature"] = errors(*measurement.mean_curvature);
  if (measurement.gaussian_curvature)
    json["gaussian_curvature"] = errors(*measurement.gaussian_curvature);
  return json.dump(2);
}

std::string measurement_table(const Measurement& measurement, const SynthOptions& truth) {
  std::string table =
      fmt::format("{} points, spacing {:.6g}\n", measurement.distance.count(), spacing(truth));
  if (measurement.not_finite > 0)
    table += fmt::format("{} more points are not finite\n", measurement.not_finite);
  table += fmt::format("{:<34}{:>12}{:>12}{:>12}{:>12}{:>12}{:>12}\n", "", "rms", "mean", "p50",
                       "p95", "p99", "max");
  table += row("distance to the surface", measurement.distance, 1);
  table += row("the same in spacings", measurement.distance, spacing(truth));
  if (measurement.normal) table += row("normal, radians", *measurement.normal, 1);
  if (measurement.mean_curvature)
    table += row("mean curvature, 1/length", *measurement.mean_curvature, 1);
  if (measurement.gaussian_curvature)
    table += row("Gaussian curvature, 1/length^2", *measurement.gaussian_curvature, 1);
  return table;
}

}  // namespace pss
