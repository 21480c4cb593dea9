#include "core/shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace pss::test {
namespace {

constexpr double kPi = std::numbers::pi;

double dot(const World3& a, const World3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

World3 moved(const World3& p, const World3& n, double t) {
  return {p[0] + t * n[0], p[1] + t * n[1], p[2] + t * n[2]};
}

double distance(const World3& a, const World3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

class EverySurface : public testing::TestWithParam<Surface> {
 protected:
  /// The order of the surface's size.
  double size() const {
    const WorldBox box = bounds(GetParam());
    return box.max[0] - box.min[0];
  }
};

INSTANTIATE_TEST_SUITE_P(Shapes, EverySurface,
                         testing::Values(Surface(Torus{1, 0.4}), Surface(Torus{25, 3}),
                                         Surface(Sphere{2.5}), Surface(Plane{30, 20, 0.3, -0.2}),
                                         Surface(Terrain(1000, 700)), Surface(Terrain(1, 1))),
                         [](const auto& tested) {
                           return shape_name(tested.param) + std::to_string(tested.index);
                         });

TEST_P(EverySurface, SamplesLieOnItWithinItsBounds) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const WorldBox box = bounds(GetParam());
  for (int i = 0; i < 2000; ++i) {
    const SurfacePoint p = surface_point(GetParam(), unit(random), unit(random));
    EXPECT_NEAR(dot(p.normal, p.normal), 1, 1e-14);
    EXPECT_NEAR(foot_of(GetParam(), p.position).distance, 0, 1e-14 * size());
    for (std::size_t a = 0; a < 3; ++a) {
      EXPECT_GE(p.position[a], box.min[a] - 1e-14 * size());
      EXPECT_LE(p.position[a], box.max[a] + 1e-14 * size());
    }
  }
}

TEST_P(EverySurface, AStepAlongTheNormalIsTheDistance) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1);
  std::uniform_real_distribution<double> step(-0.02, 0.02);
  for (int i = 0; i < 2000; ++i) {
    const SurfacePoint p = surface_point(GetParam(), unit(random), unit(random));
    const double t = step(random) * size();

    const Foot foot = foot_of(GetParam(), moved(p.position, p.normal, t));

    EXPECT_NEAR(foot.distance, t, 1e-14 * size());
    EXPECT_LT(distance(foot.position, p.position), 1e-12 * size());
    EXPECT_NEAR(dot(foot.normal, p.normal), 1, 1e-12);
  }
}

TEST_P(EverySurface, APlaceCloseBySettlesOnThePointBelow) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < 500; ++i) {
    const SurfacePoint s = surface_point(GetParam(), unit(random), unit(random));

    const SurfacePoint settled = settle(GetParam(), moved(s.position, s.normal, 1e-4 * size()));

    const Foot foot = foot_of(GetParam(), settled.position);
    EXPECT_NEAR(foot.distance, 0, 1e-14 * size());
    EXPECT_NEAR(dot(foot.normal, settled.normal), 1, 1e-12);
    EXPECT_LT(distance(settled.position, s.position), 1e-4 * size());
  }
}

TEST_P(EverySurface, NoSampleIsNearerThanTheFoot) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::uniform_real_distribution<double> step(-0.2, 0.2);
  std::vector<World3> samples;
  for (int i = 0; i < 150; ++i)
    for (int j = 0; j < 150; ++j)
      samples.push_back(surface_point(GetParam(), (i + 0.5) / 150, (j + 0.5) / 150).position);
  for (int i = 0; i < 100; ++i) {
    const SurfacePoint s = surface_point(GetParam(), unit(random), unit(random));
    const World3 p = moved(s.position, s.normal, step(random) * size());

    const Foot foot = foot_of(GetParam(), p);

    EXPECT_NEAR(distance(p, foot.position), std::abs(foot.distance), 1e-12 * size());
    for (const World3& sample : samples)
      ASSERT_GE(distance(p, sample), std::abs(foot.distance) * (1 - 1e-9));
  }
}

TEST_P(EverySurface, TheNormalIsTheGradientOfTheDistance) {
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> unit(0, 1);
  const double step = 1e-5 * size();
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint s = surface_point(GetParam(), unit(random), unit(random));
    const World3 p = moved(s.position, s.normal, 0.01 * size());
    const Foot foot = foot_of(GetParam(), p);
    for (std::size_t a = 0; a < 3; ++a) {
      World3 ahead = p, behind = p;
      ahead[a] += step;
      behind[a] -= step;
      const double slope =
          (foot_of(GetParam(), ahead).distance - foot_of(GetParam(), behind).distance) / (2 * step);
      EXPECT_NEAR(slope, foot.normal[a], 1e-6);
    }
  }
}

/// On a surface the Hessian D of the signed distance has trace -2H and the sum of its principal
/// minors of order two is K.
TEST_P(EverySurface, CurvaturesAreThoseOfTheDistanceField) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  const double step = 1e-4 * size();
  for (int i = 0; i < 200; ++i) {
    const World3 p = surface_point(GetParam(), unit(random), unit(random)).position;
    double d[3][3];
    for (std::size_t a = 0; a < 3; ++a) {
      World3 ahead = p, behind = p;
      ahead[a] += step;
      behind[a] -= step;
      const World3 after = foot_of(GetParam(), ahead).normal;
      const World3 before = foot_of(GetParam(), behind).normal;
      for (std::size_t b = 0; b < 3; ++b) d[a][b] = (after[b] - before[b]) / (2 * step);
    }
    const double mean = -(d[0][0] + d[1][1] + d[2][2]) / 2;
    const double gauss = d[0][0] * d[1][1] - d[0][1] * d[1][0] + d[0][0] * d[2][2] -
                         d[0][2] * d[2][0] + d[1][1] * d[2][2] - d[1][2] * d[2][1];

    const Foot foot = foot_of(GetParam(), p);

    EXPECT_NEAR(foot.mean_curvature * size(), mean * size(), 1e-4);
    EXPECT_NEAR(foot.gaussian_curvature * size() * size(), gauss * size() * size(), 3e-3);
  }
}

/// The area of the image of a small square of (u, v), by differences, is the same everywhere.
TEST_P(EverySurface, SamplesAreEvenByArea) {
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> unit(0.001, 0.999);
  const double step = 1e-4;
  double sum = 0;
  for (int i = 0; i < 2000; ++i) {
    const double u = unit(random);
    const double v = unit(random);
    const World3 a = surface_point(GetParam(), u + step, v).position;
    const World3 b = surface_point(GetParam(), u - step, v).position;
    const World3 c = surface_point(GetParam(), u, v + step).position;
    const World3 d = surface_point(GetParam(), u, v - step).position;
    const World3 p{a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    const World3 q{c[0] - d[0], c[1] - d[1], c[2] - d[2]};
    const double cross = std::hypot(p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2],
                                    p[0] * q[1] - p[1] * q[0]) /
                         (4 * step * step);
    EXPECT_NEAR(cross / area(GetParam()), 1, 0.03);
    sum += cross;
  }
  EXPECT_NEAR(sum / 2000 / area(GetParam()), 1, 0.002);
}

TEST(Torus, HasTheAreaAndCurvatureOfTheTextbook) {
  const Surface torus = Torus{1, 0.4};

  const Foot outer = foot_of(torus, {2, 0, 0});
  const Foot inner = foot_of(torus, {0, 0.5, 0});
  const Foot top = foot_of(torus, {0, -1, 1});

  EXPECT_NEAR(area(torus), 4 * kPi * kPi * 0.4, 1e-14);
  EXPECT_NEAR(outer.distance, 0.6, 1e-15);
  EXPECT_NEAR(outer.mean_curvature, -(1 / 0.4 + 1 / 1.4) / 2, 1e-14);
  EXPECT_NEAR(outer.gaussian_curvature, 1 / (0.4 * 1.4), 1e-14);
  EXPECT_NEAR(inner.distance, 0.1, 1e-15);
  EXPECT_NEAR(inner.mean_curvature, -(1 / 0.4 - 1 / 0.6) / 2, 1e-14);
  EXPECT_NEAR(inner.gaussian_curvature, -1 / (0.4 * 0.6), 1e-14);
  EXPECT_NEAR(top.gaussian_curvature, 0, 1e-15);
}

TEST(Sphere, CurvesAwayFromItsNormal) {
  const Foot foot = foot_of(Sphere{2}, {0, 0, -3});

  EXPECT_EQ(foot.distance, 1);
  EXPECT_EQ(foot.normal[2], -1);
  EXPECT_EQ(foot.mean_curvature, -0.5);
  EXPECT_EQ(foot.gaussian_curvature, 0.25);
}

TEST(Shapes, GiveAFootEvenWhereEveryDirectionIsAsGood) {
  EXPECT_EQ(foot_of(Sphere{2}, {0, 0, 0}).distance, -2);
  EXPECT_NEAR(foot_of(Torus{1, 0.4}, {0, 0, 0}).distance, 0.6, 1e-15);
  EXPECT_NEAR(foot_of(Torus{1, 0.4}, {1, 0, 0}).distance, -0.4, 1e-15);
}

TEST(Terrain, FindsTheFootOfPointsFarOffByBruteForce) {
  const Terrain terrain(100, 100);
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> across(-40, 40);
  std::uniform_real_distribution<double> up(-60, 60);
  for (int i = 0; i < 15; ++i) {
    const World3 p{across(random), across(random), up(random)};
    double least = 1e300;
    for (double x = -100; x <= 100; x += 0.5)
      for (double y = -100; y <= 100; y += 0.5)
        least = std::min(least, distance(p, {x, y, terrain.height(x, y).z}));

    const Foot foot = foot_of(terrain, p);

    EXPECT_LE(std::abs(foot.distance), least);
    EXPECT_NEAR(std::abs(foot.distance), least, 0.05);
  }
}

TEST(SolveKepler, InvertsTheEquationForEveryEccentricity) {
  for (const double e : {0.0, 0.1, 0.4, 0.9, 0.999}) {
    for (int i = -100; i <= 100; ++i) {
      const double x = kPi * i / 100;
      const double m = x + e * std::sin(x);
      const double solved = solve_kepler(m, e);
      EXPECT_NEAR(solved + e * std::sin(solved), m, 1e-13) << "e " << e << " x " << x;
    }
  }
}

}  // namespace
}  // namespace pss::test
