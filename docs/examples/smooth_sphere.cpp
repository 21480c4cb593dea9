// Smooths a noisy sphere in memory, then asks its surface what lies near some other places.
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include "core/mls_surface.h"

namespace {

/// Evenly spread points on the unit sphere (a Fibonacci spiral), moved along their normals.
std::vector<pss::World3> noisy_sphere(int count, double sigma) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, sigma);
  std::vector<pss::World3> points;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count;
    const double angle = i * std::numbers::pi * (3 - std::sqrt(5.0));
    const double ring = std::sqrt(1 - z * z);
    const double r = 1 + noise(random);
    points.push_back({r * ring * std::cos(angle), r * ring * std::sin(angle), r * z});
  }
  return points;
}

double rms_distance(const std::vector<pss::World3>& points) {
  double sum = 0;
  for (const pss::World3& p : points) sum += std::pow(std::hypot(p[0], p[1], p[2]) - 1, 2);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace

int main() {
  const int count = 10000;
  const double spacing = std::sqrt(4 * std::numbers::pi / count);
  const std::vector<pss::World3> points = noisy_sphere(count, 0.3 * spacing);

  // Every point onto the surface of all of them.
  pss::MlsOptions options;
  options.h = 4 * spacing;
  const auto smoothed = pss::smooth(points, options);
  if (!smoothed) {
    std::fprintf(stderr, "%s\n", smoothed.error().message.c_str());
    return 1;
  }
  const double before = rms_distance(points);
  const double after = rms_distance(smoothed->positions);
  std::printf("rms distance to the sphere: %.5f before, %.5f after\n", before, after);
  std::printf("ratio %.3f, in theory %.3f\n", after / before, 0.631 * spacing / options.h);

  // The same surface, kept, and asked anywhere near it. A status says what became of each query.
  const auto surface = pss::MlsSurface::create(points, options);
  if (!surface) return 1;
  const std::vector<pss::World3> queries{{0, 0, 1.03}, {0.57, 0.57, 0.57}, {0, 0, 5}};
  const pss::Projected found = surface->project(queries);
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const pss::World3& p = found.positions[i];
    const pss::Projection& there = found.results[i];
    std::printf("%s: (%.3f, %.3f, %.3f), normal (%.2f, %.2f, %.2f), mean curvature %.2f\n",
                pss::status_name(there.status), p[0], p[1], p[2], there.normal[0], there.normal[1],
                there.normal[2], there.mean_curvature);
  }
}
