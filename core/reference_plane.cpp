#include "core/reference_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "core/symmetric3.h"

namespace pss {
namespace {

constexpr double kFarthest = 0.5;    // bound of |t|
constexpr double kConverged = 1e-8;  // the error after such a step is its square
constexpr double kRounding = 1e-15;  // a residual that no step can improve
constexpr double kMostTurn = 0.3;    // radians a step
constexpr double kMostSlide = 0.25;  // of h a step
constexpr double kTie = 1e-10;       // eigenvalues closer than this, of the largest, are equal
constexpr int kMostPasses = 64;
constexpr int kMostHalvings = 3;
constexpr int kMostPushes = 4;      // against the bound of t
constexpr int kAlternations = 4;    // passes before Newton is tried again
constexpr std::size_t kFewest = 3;  // points that a plane needs

/// Sums over the neighbours about the query: weights frozen there.
struct StartSums {
  std::size_t count = 0;  // of neighbours with a weight
  double w = 0;
  World3 p{0, 0, 0};
  Symmetric3 pp;
};

StartSums sum_about_query(const Neighbourhood& near) {
  StartSums s;
  for_each_block<WeightedBlock>(near, Frame{}, 0, [&](const WeightedBlock& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      const double w = b.weight[i];
      const double wx = w * b.x[i];
      const double wy = w * b.y[i];
      const double wz = w * b.d[i];
      s.count += w > 0;
      s.w += w;
      s.p[0] += wx;
      s.p[1] += wy;
      s.p[2] += wz;
      s.pp.xx += wx * b.x[i];
      s.pp.xy += wx * b.y[i];
      s.pp.xz += wx * b.d[i];
      s.pp.yy += wy * b.y[i];
      s.pp.yz += wy * b.d[i];
      s.pp.zz += wz * b.d[i];
    }
  });
  return s;
}

/// Covariance about the weighted centroid, from sums about the query.
Symmetric3 covariance(const StartSums& s, const World3& c) {
  const auto about = [&](double sum, std::size_t i, std::size_t j) {
    return sum / s.w - c[i] * c[j];
  };
  return {about(s.pp.xx, 0, 0), about(s.pp.xy, 0, 1), about(s.pp.xz, 0, 2),
          about(s.pp.yy, 1, 1), about(s.pp.yz, 1, 2), about(s.pp.zz, 2, 2)};
}

/// Whether one direction alone is the smallest, and the points spread along the other two.
bool determines_plane(const EigenSystem& e) {
  const double least = kTie * e.values[2];
  return e.values[2] > 1e-24 && e.values[1] > least && e.values[1] - e.values[0] > least;
}

double bounded(double t) { return t < -kFarthest ? -kFarthest : t > kFarthest ? kFarthest : t; }

/// The smallest direction of the covariance about the weighted centroid, and its plane's height.
ReferencePlane starting_plane(const Neighbourhood& near) {
  const StartSums sums = sum_about_query(near);
  if (sums.count < kFewest) return {};
  const World3 centroid = 1 / sums.w * sums.p;
  const EigenSystem eigen = eigen_decomposition(covariance(sums, centroid));
  if (!determines_plane(eigen)) return {Status::kDegenerate, {}, 0, 0};
  const World3 n = normalized(eigen.vectors[0]);
  return {Status::kOk, n, bounded(dot(n, centroid)), 0};
}

/// All sums of one pass about q = t n: the conditions, their Jacobian, the covariance about q.
///
/// Per neighbour: in-plane coordinates x, y, height d, weight w and its derivatives w', w''.
struct PassSums {
  double w = 0, wx = 0, wy = 0, wd = 0;                   // w {1, x, y, d}
  double xx = 0, xy = 0, yy = 0, xd = 0, yd = 0, dd = 0;  // w {x^2, ...}
  double axx = 0, axy = 0, ayy = 0;                       // w' d {x^2, x y, y^2}
  double bx = 0, by = 0;                                  // w' d^2 {x, y}
  double cubic = 0;                                       // w' d^3
  double ex = 0, ey = 0;                                  // d (w' + d^2 w'') {x, y}
  double curvature = 0;                                   // d^2 (5 w' + 2 d^2 w'')
};

PassSums sum_about_foot(const Neighbourhood& near, const Frame& frame, double t) {
  PassSums s;
  for_each_block<DerivativeBlock>(near, frame, t, [&](const DerivativeBlock& block) {
    PassSums r = s;  // in registers as far as they go
    for (std::size_t i = 0; i < block.count; ++i) {
      const double x = block.x[i];
      const double y = block.y[i];
      const double d = block.d[i];
      const double w = block.weight[i];
      const double w1 = block.first[i];
      const double w2 = block.second[i];
      const double wx = w * x;
      const double wy = w * y;
      const double d2 = d * d;
      const double a = w1 * d;
      const double ax = a * x;
      const double ay = a * y;
      const double e = d * (w1 + d2 * w2);
      r.w += w;
      r.wx += wx;
      r.wy += wy;
      r.wd += w * d;
      r.xx += wx * x;
      r.xy += wx * y;
      r.yy += wy * y;
      r.xd += wx * d;
      r.yd += wy * d;
      r.dd += w * d2;
      r.axx += ax * x;
      r.axy += ax * y;
      r.ayy += ay * y;
      r.bx += ax * d;
      r.by += ay * d;
      r.cubic += a * d2;
      r.ex += e * x;
      r.ey += e * y;
      r.curvature += d2 * (5 * w1 + 2 * d2 * w2);
    }
    s = r;
  });
  return s;
}

/// A move of the plane: turned by `a` towards u and `b` towards v, slid by `t` along the normal.
struct Step {
  double a = 0;
  double b = 0;
  double t = 0;

  double size() const { return std::max({std::abs(a), std::abs(b), std::abs(t)}); }
  Step scaled(double s) const { return {s * a, s * b, s * t}; }
};

/// The conditions F at one place and their Jacobian in (a, b, t), divided by the sum of weights.
struct Conditions {
  std::array<double, 3> f;
  std::array<std::array<double, 3>, 3> jacobian;

  Conditions(const PassSums& s, double t) {
    const double per_w = 1 / s.w;
    f = {s.xd * per_w, s.yd * per_w, (s.wd + s.cubic) * per_w};
    const double turn = s.dd + t * s.wd;
    jacobian[0] = {(s.xx - turn - 2 * t * s.axx) * per_w, (s.xy - 2 * t * s.axy) * per_w,
                   -(s.wx + 2 * s.bx) * per_w};
    jacobian[1] = {jacobian[0][1], (s.yy - turn - 2 * t * s.ayy) * per_w,
                   -(s.wy + 2 * s.by) * per_w};
    jacobian[2] = {(s.wx + 3 * s.bx - 2 * t * s.ex) * per_w,
                   (s.wy + 3 * s.by - 2 * t * s.ey) * per_w, -(s.w + s.curvature) * per_w};
  }

  double residual() const { return std::sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]); }
};

/// Whether both conditions are at a minimum of theirs: the normal along the one smallest
/// direction of the covariance about q, the weighted squares convex along the normal.
bool at_minimum(const PassSums& s) {
  const double xx = s.xx - s.dd;
  const double yy = s.yy - s.dd;
  const double least = kTie * (s.xx + s.yy + s.dd);
  return xx > least && xx * yy - s.xy * s.xy > least * (xx + yy) && s.w + s.curvature > 0;
}

/// Solves J step = -F by elimination with column pivots; nothing where J is singular.
std::optional<Step> newton_step(const Conditions& c) {
  std::array<std::array<double, 4>, 3> m;
  for (std::size_t i = 0; i < 3; ++i)
    m[i] = {c.jacobian[i][0], c.jacobian[i][1], c.jacobian[i][2], -c.f[i]};
  for (std::size_t k = 0; k < 3; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < 3; ++i)
      if (std::abs(m[i][k]) > std::abs(m[pivot][k])) pivot = i;
    std::swap(m[k], m[pivot]);
    if (!(std::abs(m[k][k]) > 1e-30)) return std::nullopt;
    for (std::size_t i = k + 1; i < 3; ++i) {
      const double factor = m[i][k] / m[k][k];
      for (std::size_t j = k; j < 4; ++j) m[i][j] -= factor * m[k][j];
    }
  }
  Step step;
  step.t = m[2][3] / m[2][2];
  step.b = (m[1][3] - m[1][2] * step.t) / m[1][1];
  step.a = (m[0][3] - m[0][1] * step.b - m[0][2] * step.t) / m[0][0];
  return step;
}

/// The step, shortened to the most that one pass may move.
Step bounded(const Step& step) {
  const double turn = std::sqrt(step.a * step.a + step.b * step.b);
  double scale = 1;
  if (turn > kMostTurn) scale = kMostTurn / turn;
  if (std::abs(step.t) * scale > kMostSlide) scale = kMostSlide / std::abs(step.t);
  return step.scaled(scale);
}

/// Finds the plane pass by pass; every decision depends on this neighbourhood's numbers alone.
class Search {
 public:
  Search(const Neighbourhood& near, const ReferencePlane& start)
      : near_(near), frame_(frame_of(start.normal)), t_(start.t) {}

  ReferencePlane run() {
    while (passes_ < kMostPasses) {
      const PassSums sums = sum_about_foot(near_, frame_, t_);
      ++passes_;
      if (!(sums.w > 0)) return plane(Status::kTooFew);
      if (const std::optional<Status> end = advance(sums)) return plane(*end);
    }
    return plane(Status::kDegenerate);
  }

 private:
  /// Decides on one pass's sums: moves on, or says how the search ends.
  std::optional<Status> advance(const PassSums& sums) {
    const Conditions conditions(sums, t_);
    const bool pushed = std::abs(t_) >= kFarthest && conditions.f[2] * t_ > 0;
    if (pushed && ++pushes_ >= kMostPushes) return Status::kOutOfDomain;
    const bool minimum = at_minimum(sums);
    const bool worse = !minimum || (!pushed && conditions.residual() > last_residual_);
    if (after_newton_ && worse) return halve(), std::nullopt;
    const std::optional<Step> step =
        minimum && alternations_ == 0 ? newton_step(conditions) : std::nullopt;
    if (!step) return alternate(sums, conditions), std::nullopt;
    go(bounded(*step), conditions.residual());
    const bool converged = step->size() <= kConverged || last_residual_ <= kRounding;
    const bool inside = std::abs(t_) < kFarthest;
    return converged && inside ? std::optional(Status::kOk) : std::nullopt;
  }

  /// Takes the last step back by half; after too many, gives Newton's method up for a while.
  void halve() {
    if (++halvings_ > kMostHalvings) {
      alternations_ = kAlternations << failures_++;
      after_newton_ = false;
    }
    last_step_ = last_step_.scaled(0.5);
    move(last_frame_, last_t_, last_step_);
  }

  void go(const Step& step, double residual) {
    halvings_ = 0;
    after_newton_ = true;
    last_residual_ = residual;
    last_frame_ = frame_;
    last_t_ = t_;
    last_step_ = step;
    move(frame_, t_, step);
  }

  /// The fallback: the normal from the covariance about q, then t along that normal, where the
  /// second condition is taken as linear in the turn.
  void alternate(const PassSums& sums, const Conditions& c) {
    after_newton_ = false;
    halvings_ = 0;
    if (alternations_ > 0) --alternations_;
    const Step turned = turn(sums);
    const double convexity = -c.jacobian[2][2];
    const double f = c.f[2] + c.jacobian[2][0] * turned.a + c.jacobian[2][1] * turned.b;
    const double slide = convexity > 0 ? bounded(Step{0, 0, f / convexity}).t
                                       : std::copysign(kMostSlide / 2, c.f[2]);
    t_ = bounded(t_ + slide);
  }

  /// Takes the smallest direction of the covariance about q as normal; returns the turn.
  Step turn(const PassSums& s) {
    const double per_w = 1 / s.w;
    World3 e = eigen_decomposition({s.xx * per_w, s.xy * per_w, s.xd * per_w, s.yy * per_w,
                                    s.yd * per_w, s.dd * per_w})
                   .vectors[0];
    if (e[2] < 0) e = -e;
    frame_ = frame_of(normalized(e[0] * frame_.u + e[1] * frame_.v + e[2] * frame_.n));
    return {e[0], e[1], 0};
  }

  void move(const Frame& frame, double t, const Step& step) {
    frame_ = frame_of(normalized(frame.n + step.a * frame.u + step.b * frame.v));
    t_ = bounded(t + step.t);
  }

  ReferencePlane plane(Status status) const {
    if (is_canonical(frame_.n)) return {status, frame_.n, t_, passes_};
    return {status, -frame_.n, -t_, passes_};
  }

  const Neighbourhood& near_;
  Frame frame_;
  double t_;
  Frame last_frame_;
  double last_t_ = 0;
  Step last_step_;
  double last_residual_ = 0;
  bool after_newton_ = false;  // the last move was Newton's step, whole or halved
  int passes_ = 0;
  int halvings_ = 0;
  int alternations_ = 0;
  int failures_ = 0;  // of Newton's method
  int pushes_ = 0;    // passes on which t stood at its bound and was pushed against it
};

}  // namespace

ReferencePlane find_reference_plane(const Neighbourhood& near) {
  const ReferencePlane start = starting_plane(near);
  return start.status == Status::kOk ? Search(near, start).run() : start;
}

}  // namespace pss
