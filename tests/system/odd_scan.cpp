// Writes scans whose points lie as no scanner's should: what a memory limit is tested with.
//
// odd_scan SHAPE POINTS FILE: a binary PLY file of doubles, the same bytes every time.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numbers>
#include <string_view>
#include <vector>

namespace {

using Point = std::array<double, 3>;

/// Sequence numbers to numbers in [0, 1): the finaliser of splitmix64.
double uniform(std::uint64_t i) {
  i = (i ^ i >> 30) * 0xbf58476d1ce4e5b9;
  i = (i ^ i >> 27) * 0x94d049bb133111eb;
  return static_cast<double>((i ^ i >> 31) >> 11) * 0x1p-53;
}

/// Three independent numbers of point `i`.
Point uniforms(std::uint64_t i) {
  constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15;
  return {uniform((3 * i + 1) * kStep), uniform((3 * i + 2) * kStep), uniform((3 * i + 3) * kStep)};
}

/// A bent sheet over the unit square with some noise: the even case.
Point sheet(const Point& u, double noise) {
  const double bend = 0.05 * std::sin(6 * u[0]) * std::cos(5 * u[1]);
  return {u[0], u[1], bend + noise * (u[2] - 0.5)};
}

/// One turn of a scanner on a tripod over flat ground: as many points in each octave of distance,
/// so that their density falls with its square, 10^6-fold.
Point terrestrial(const Point& u) {
  const double r = std::pow(1e3, u[0]), angle = 2 * std::numbers::pi * u[1];
  return {r * std::cos(angle), r * std::sin(angle), 1e-4 * r * (u[2] - 0.5)};
}

/// The last `few` points of `count` lie up to `factor` scans away.
Point far_away(std::uint64_t i, double factor) {
  const Point u = uniforms(~i);
  return {factor * (u[0] - 0.5), factor * (u[1] - 0.5), factor * (u[2] - 0.5)};
}

Point place(std::string_view shape, std::uint64_t i, std::uint64_t count) {
  const Point u = uniforms(i);
  const double noise = 1 / std::sqrt(static_cast<double>(count));
  if (shape == "terrestrial") return terrestrial(u);
  if (shape == "corner") return i + 1 < count ? sheet(u, noise) : Point{1e5, 1e5, 1e5};
  if (shape == "outliers") return i + 20 < count ? sheet(u, noise) : far_away(i, 1e6);
  if (shape == "equal") return {0.25, 0.5, 0.75};
  if (shape == "copies")  // hundreds of thousands on each of few places
    return sheet(uniforms(i % std::max<std::uint64_t>(count / 200000, 1)), noise);
  if (shape == "pile") return i % 4 ? sheet(u, noise) : Point{0.5, 0.5, 0};
  if (shape == "plane") return {u[0], u[1], 0};
  if (shape == "line") return {u[0], 0, 0};
  if (shape == "volume") return u;
  return sheet(u, noise);
}

bool write(std::FILE* file, std::string_view shape, std::uint64_t count) {
  std::fprintf(file,
               "ply\nformat binary_little_endian 1.0\nelement vertex %llu\nproperty double x\n"
               "property double y\nproperty double z\nend_header\n",
               static_cast<unsigned long long>(count));
  std::vector<Point> points;
  for (std::uint64_t i = 0; i < count;) {
    points.clear();
    for (; i < count && points.size() < 65536; ++i) points.push_back(place(shape, i, count));
    if (std::fwrite(points.data(), sizeof(Point), points.size(), file) != points.size())
      return false;
  }
  return std::fflush(file) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(argv[3], "wb"),
                                                             std::fclose);
  return file && write(file.get(), argv[1], std::strtoull(argv[2], nullptr, 10)) ? 0 : 1;
}
