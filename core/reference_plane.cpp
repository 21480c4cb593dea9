#include "core/reference_plane.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

#include "core/plane_conditions.h"
#include "core/symmetric3.h"

namespace pss {
namespace {

constexpr double kFarthest = 0.5;    // bound of |t|
constexpr double kSettled = 1e-3;    // a move of `fast` that ends its search
constexpr double kConverged = 1e-8;  // the error after such a step is its square
constexpr double kRounding = 1e-15;  // a residual that no step can improve
constexpr double kMostTurn = 0.3;    // radians a step
constexpr double kMostSlide = 0.25;  // of h a step
constexpr int kMostPasses = 64;
constexpr int kMostHalvings = 3;
constexpr int kMostPushes = 4;      // against the bound of t
constexpr int kAlternations = 4;    // passes before Newton is tried again
constexpr std::size_t kFewest = 3;  // points that a plane needs

/// Sums over the neighbours about a place: weights frozen there.
struct StartSums {
  std::size_t count = 0;  // of neighbours with a weight
  double w = 0;
  World3 p{0, 0, 0};
  Symmetric3 pp;
};

/// Coordinates are those of the frame, seen from its point t n.
StartSums sum_about(const Neighbourhood& near, const Frame& frame, double t) {
  StartSums s;
  for_each_block<WeightedBlock>(near, frame, t, [&](const WeightedBlock& b) {
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
  const double least = kEigenvalueTie * e.values[2];
  return e.values[2] > 1e-24 && e.values[1] > least && e.values[1] - e.values[0] > least;
}

double bounded(double t) { return t < -kFarthest ? -kFarthest : t > kFarthest ? kFarthest : t; }

/// The smallest direction of the covariance about the weighted centroid, and its plane's height;
/// weights about the point t n of the frame.
ReferencePlane weighted_plane(const Neighbourhood& near, const Frame& frame, double t) {
  const StartSums sums = sum_about(near, frame, t);
  if (sums.count < kFewest) return {};
  const World3 c = 1 / sums.w * sums.p;
  const EigenSystem eigen = eigen_decomposition(covariance(sums, c));
  if (!determines_plane(eigen)) return {Status::kDegenerate, {}, 0, 0};
  const World3 e = normalized(eigen.vectors[0]);
  const World3 n = e[0] * frame.u + e[1] * frame.v + e[2] * frame.n;
  return {Status::kOk, n, bounded(dot(e, c) + t * e[2]), 0};
}

/// The step, shortened to the most that one pass may move.
PlaneStep bounded(const PlaneStep& step) {
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
    const PlaneConditions conditions(sums, t_);
    const bool pushed = std::abs(t_) >= kFarthest && conditions.f[2] * t_ > 0;
    if (pushed && ++pushes_ >= kMostPushes) return Status::kOutOfDomain;
    const bool minimum = at_minimum(sums);
    const bool worse = !minimum || (!pushed && conditions.residual() > last_residual_);
    if (after_newton_ && worse) return halve(), std::nullopt;
    const std::optional<PlaneStep> step =
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

  void go(const PlaneStep& step, double residual) {
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
  void alternate(const PassSums& sums, const PlaneConditions& c) {
    after_newton_ = false;
    halvings_ = 0;
    if (alternations_ > 0) --alternations_;
    const PlaneStep turned = turn(sums);
    const double convexity = -c.jacobian[2][2];
    const double f = c.f[2] + c.jacobian[2][0] * turned.a + c.jacobian[2][1] * turned.b;
    const double slide = convexity > 0 ? bounded(PlaneStep{0, 0, f / convexity}).t
                                       : std::copysign(kMostSlide / 2, c.f[2]);
    t_ = bounded(t_ + slide);
  }

  /// Takes the smallest direction of the covariance about q as normal; returns the turn.
  PlaneStep turn(const PassSums& s) {
    const double per_w = 1 / s.w;
    World3 e = eigen_decomposition({s.xx * per_w, s.xy * per_w, s.xd * per_w, s.yy * per_w,
                                    s.yd * per_w, s.dd * per_w})
                   .vectors[0];
    if (e[2] < 0) e = -e;
    frame_ = frame_of(normalized(e[0] * frame_.u + e[1] * frame_.v + e[2] * frame_.n));
    return {e[0], e[1], 0};
  }

  void move(const Frame& frame, double t, const PlaneStep& step) {
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
  PlaneStep last_step_;
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
  const ReferencePlane start = weighted_plane(near, Frame{}, 0);
  return start.status == Status::kOk ? Search(near, start).run() : start;
}

ReferencePlane find_settled_plane(const Neighbourhood& near) {
  ReferencePlane plane = weighted_plane(near, Frame{}, 0);
  for (int pass = 1; plane.status == Status::kOk; ++pass) {
    ReferencePlane next = weighted_plane(near, frame_of(plane.normal), plane.t);
    next.passes = pass;
    if (next.status != Status::kOk) return next;
    if (dot(next.normal, plane.normal) < 0) next = {next.status, -next.normal, -next.t, pass};
    const World3 turn = next.normal - plane.normal;
    const double move = std::max(
        {std::abs(turn[0]), std::abs(turn[1]), std::abs(turn[2]), std::abs(next.t - plane.t)});
    plane = next;
    if (move <= kSettled) break;
    if (pass == kMostPasses) plane.status = Status::kDegenerate;
  }
  if (plane.status == Status::kOk && std::abs(plane.t) >= kFarthest)
    plane.status = Status::kOutOfDomain;
  if (!is_canonical(plane.normal)) plane = {plane.status, -plane.normal, -plane.t, plane.passes};
  return plane;
}

}  // namespace pss
