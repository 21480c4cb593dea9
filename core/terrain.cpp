#include "core/terrain.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/sin_cos.h"

namespace pss {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

/// amplitude * sin(2 pi (x * place_x + y * place_y) + phase), all in units of the width.
struct Wave {
  double amplitude, x, y, phase;
};

constexpr std::array kWaves = {
    Wave{0.030, 1.0, 0.5, 0.3},
    Wave{0.015, -1.3, 1.9, 1.1},
    Wave{0.008, 3.1, 1.7, 2.5},
    Wave{0.003, -2.3, 6.1, 0.7},
};

/// A single start finds the foot of points nearer than this (in widths) to the surface: its
/// smallest radius of curvature is 0.07.
constexpr double kNear = 0.03;

/// The height in units of the width at a place in units of the width.
Height unit_height(double x, double y) {
  Height h;
  for (const Wave& wave : kWaves) {
    const double kx = kTwoPi * wave.x;
    const double ky = kTwoPi * wave.y;
    const double turns = wave.x * x + wave.y * y;
    const double angle = kTwoPi * (turns - std::floor(turns)) + wave.phase;
    const auto [sine, cosine] = sin_cos(angle);
    const double s = wave.amplitude * sine;
    const double c = wave.amplitude * cosine;
    h.z += s;
    h.x += kx * c;
    h.y += ky * c;
    h.xx -= kx * kx * s;
    h.xy -= kx * ky * s;
    h.yy -= ky * ky * s;
  }
  return h;
}

std::vector<double> area_densities(double depth_over_width) {
  constexpr std::size_t kNodes = DensityMap::kCells + 1;
  std::vector<double> density(kNodes * kNodes);
  for (std::size_t i = 0; i < kNodes; ++i) {
    for (std::size_t j = 0; j < kNodes; ++j) {
      const double x = static_cast<double>(i) / DensityMap::kCells - 0.5;
      const double y = (static_cast<double>(j) / DensityMap::kCells - 0.5) * depth_over_width;
      const Height h = unit_height(x, y);
      density[i * kNodes + j] = std::sqrt(1 + h.x * h.x + h.y * h.y);
    }
  }
  return density;
}

/// The step that Newton's method takes to the nearest point; Gauss-Newton's where it would climb.
std::array<double, 2> foot_step(const Height& h, double dx, double dy, double dz) {
  const double gx = dx + dz * h.x;
  const double gy = dy + dz * h.y;
  double a = 1 + h.x * h.x + dz * h.xx;
  double b = h.x * h.y + dz * h.xy;
  double c = 1 + h.y * h.y + dz * h.yy;
  if (!(a > 0.1 && a * c - b * b > 0.1)) {
    a = 1 + h.x * h.x;
    b = h.x * h.y;
    c = 1 + h.y * h.y;
  }
  const double determinant = a * c - b * b;
  return {-(c * gx - b * gy) / determinant, -(a * gy - b * gx) / determinant};
}

}  // namespace

DensityMap::DensityMap(const std::vector<double>& density)
    : columns_(density.size(), 0.0), marginal_(kCells + 1, 0.0) {
  constexpr double kHalfStep = 0.5 / kCells;
  for (std::size_t i = 0; i <= kCells; ++i) {
    const std::size_t first = i * (kCells + 1);
    for (std::size_t k = first + 1; k <= first + kCells; ++k)
      columns_[k] = columns_[k - 1] + kHalfStep * (density[k - 1] + density[k]);
    if (i > 0)
      marginal_[i] = marginal_[i - 1] + kHalfStep * (column(i - 1)[kCells] + column(i)[kCells]);
  }
}

std::array<double, 2> DensityMap::map(double u, double v) const {
  const double mass = u * total();
  const auto after = std::upper_bound(marginal_.begin() + 1, marginal_.end() - 1, mass);
  const auto i = static_cast<std::size_t>(after - marginal_.begin()) - 1;
  const double* left = column(i);
  const double* right = column(i + 1);
  // The column mass is linear between nodes: rest = a t + (b - a) t^2 / 2, solved without
  // cancellation.
  const double a = left[kCells];
  const double b = right[kCells];
  const double rest = std::max(0.0, (mass - marginal_[i]) * kCells);
  const double t = std::min(1.0, 2 * rest / (a + std::sqrt(a * a + 2 * (b - a) * rest)));

  const auto cumulated = [&](std::size_t j) { return left[j] + t * (right[j] - left[j]); };
  const double target = v * cumulated(kCells);
  std::size_t low = 0;
  for (std::size_t step = kCells / 2; step > 0; step /= 2)
    if (cumulated(low + step) <= target) low += step;
  const double below = cumulated(low);
  const double s = std::clamp((target - below) / (cumulated(low + 1) - below), 0.0, 1.0);
  return {(static_cast<double>(i) + t) / kCells, (static_cast<double>(low) + s) / kCells};
}

Terrain::Terrain(double width, double depth)
    : width_(width), depth_(depth), map_(area_densities(depth / width)) {}

double Terrain::amplitude() const {
  double sum = 0;
  for (const Wave& wave : kWaves) sum += wave.amplitude;
  return sum * width_;
}

Height Terrain::height(double x, double y) const {
  Height h = unit_height(x / width_, y / width_);
  h.z *= width_;
  h.xx /= width_;
  h.xy /= width_;
  h.yy /= width_;
  return h;
}

std::array<double, 2> Terrain::place(double u, double v) const {
  const auto [x, y] = map_.map(u, v);
  return {(x - 0.5) * width_, (y - 0.5) * depth_};
}

double Terrain::distance_sq(const World3& p, double x, double y) const {
  const double dx = x - p[0];
  const double dy = y - p[1];
  const double dz = height(x, y).z - p[2];
  return dx * dx + dy * dy + dz * dz;
}

std::array<double, 2> Terrain::descend(const World3& p, double x, double y) const {
  constexpr int kMaxSteps = 60;
  double least = distance_sq(p, x, y);
  for (int step = 0; step < kMaxSteps; ++step) {
    const Height h = height(x, y);
    auto [dx, dy] = foot_step(h, x - p[0], y - p[1], h.z - p[2]);
    double length = std::abs(dx) + std::abs(dy);
    // Below this the distance no longer tells steps apart, and Newton's method converges.
    while (length > 1e-6 * width_ && distance_sq(p, x + dx, y + dy) > least) {
      dx /= 2;
      dy /= 2;
      length /= 2;
    }
    x += dx;
    y += dy;
    least = distance_sq(p, x, y);
    if (!(length > 1e-9 * width_)) break;  // squared by the step just taken
  }
  return {x, y};
}

std::array<double, 2> Terrain::nearest(const World3& p) const {
  std::array<double, 2> best = descend(p, p[0], p[1]);
  const double gap = std::abs(p[2] - height(p[0], p[1]).z);
  if (!(gap > kNear * width_)) return best;
  // The foot is no farther than the point straight below, and no hill is higher than the amplitude:
  // a descent from every place of a grid over that disc.
  const double clearance = std::max(0.0, std::abs(p[2]) - amplitude());
  const double reach = std::sqrt(std::max(0.0, gap * gap - clearance * clearance));
  const int steps = static_cast<int>(std::clamp(reach / (kNear * width_) + 1, 2.0, 12.0));
  double least = distance_sq(p, best[0], best[1]);
  for (int i = -steps; i <= steps; ++i) {
    for (int j = -steps; j <= steps; ++j) {
      const auto [x, y] = descend(p, p[0] + reach * i / steps, p[1] + reach * j / steps);
      const double found = distance_sq(p, x, y);
      if (found >= least) continue;
      least = found;
      best = {x, y};
    }
  }
  return best;
}

}  // namespace pss
