#include "core/mls_surface.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "core/morton.h"
#include "core/parallel.h"
#include "core/support.h"
#include "core/vec3.h"

namespace pss {
namespace {

constexpr std::size_t kChunkQueries = 1024;  ///< what one task computes
/// A cell grid wants some width, also where no query looks around.
constexpr double kSmallestReach = std::numeric_limits<double>::min();

/// Queries on their way through a projector; equal neighbours are one question.
struct Batch {
  static constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

  std::vector<Query> queries;
  std::vector<Support> supports;
  std::vector<std::size_t> slots;  ///< which of the queries an item asked, or kNone

  bool ends_with(const Query& query) const {
    return !queries.empty() && queries.back().position == query.position &&
           queries.back().remainder == query.remainder;
  }

  void add(const Query& query, const std::optional<Support>& support) {
    if (support) {
      queries.push_back(query);
      supports.push_back(*support);
    }
    slots.push_back(support ? queries.size() - 1 : kNone);
  }

  void add_again() { slots.push_back(queries.size() - 1); }
};

}  // namespace

Result<MlsSurface> MlsSurface::create(std::span<const World3> points, const MlsOptions& options,
                                      const CloudNormals& normals) {
  PSS_TRY(check_options(options));
  PSS_ASSIGN(SortedCloud cloud, sort_cloud(points, normals.values, options.lattice));
  const MlsWidths widths = choose_widths(options, cloud);
  if (needs_normals(options.method.op) && cloud.normals.empty())
    cloud = with_normals(std::move(cloud), normals_method(options.method), widths);
  const bool oriented = normals.oriented && !normals.values.empty();
  return MlsSurface(std::move(cloud), oriented, options.method, widths);
}

/// The cloud with the normals of the surface that `method` makes of it; zeros where a point stays.
SortedCloud MlsSurface::with_normals(SortedCloud cloud, const Method& method,
                                     const MlsWidths& widths) {
  MlsSurface surface(std::move(cloud), false, method, widths);
  std::vector<Normal> normals(surface.size());
  surface.for_each_point([&](std::size_t i, const Projection& projection) {
    Normal stored{};  // as a file holds it, so that files give the same
    for (std::size_t a = 0; a < 3; ++a) stored[a] = static_cast<float>(projection.normal[a]);
    normals[i] = unit_normal(stored);
  });
  surface.cloud_.normals = std::move(normals);
  return std::move(surface.cloud_);
}

MlsSurface::MlsSurface(SortedCloud cloud, bool oriented, const Method& method,
                       const MlsWidths& widths)
    : cloud_(std::move(cloud)),
      oriented_(oriented),
      method_(method),
      widths_(widths),
      grid_(cloud_.lattice, cloud_.points, std::max(widest_reach(widths, method), kSmallestReach)) {
  for (const Index3& p : cloud_.points) bounds_.add(to_world(cloud_.lattice, p));
}

/// Whether `place` may have neighbours; false for what is not finite.
bool MlsSurface::in_reach(const World3& place) const {
  const double far = 1.01 * widest_reach(widths_, method_) + cloud_.lattice.scale[0];
  for (std::size_t a = 0; a < 3; ++a)
    if (!(place[a] >= bounds_.min[a] - far && place[a] <= bounds_.max[a] + far)) return false;
  return !widths_.nearest || on_lattice(cloud_.lattice, place);
}

/// The query at `place`: its nearest lattice position and the rest, however much that is.
Query MlsSurface::query_at(const World3& place) const {
  Query query;
  for (std::size_t a = 0; a < 3; ++a) {
    const double steps = (place[a] - cloud_.lattice.origin[a]) / cloud_.lattice.scale[a];
    query.position[a] = std::llrint(
        std::clamp(steps, static_cast<double>(kLatticeMin), static_cast<double>(kLatticeMax)));
  }
  query.remainder = place - to_world(cloud_.lattice, query.position);
  return query;
}

/// Empty where the query has no width to look with.
std::optional<Support> MlsSurface::support_of(const Query& query) const {
  if (widths_.nearest) {
    const std::optional<double> distance =
        grid_.kth_distance(query.position, widths_.nearest, widths_.cap);
    if (!distance) return std::nullopt;
    return support_of_radius(*distance, method_);
  }
  if (!(widths_.support.radius > 0)) return std::nullopt;
  return widths_.support;
}

/// What a query gets that has no width, or nothing within it.
Projection MlsSurface::lonely() const {
  Projection projection;
  projection.status = widths_.nearest ? Status::kIsolated : Status::kTooFew;
  return projection;
}

/// Calls use(i, projection) for the queries query_at(i), which are in key order.
template <class QueryAt, class Use>
void MlsSurface::for_each_projection(std::size_t count, QueryAt query_at, Use use) const {
  parallel_for(count, kChunkQueries, [&](std::size_t begin, std::size_t end) {
    Batch batch;
    for (std::size_t i = begin; i < end; ++i) {
      const Query query = query_at(i);
      if (batch.ends_with(query))
        batch.add_again();
      else
        batch.add(query, support_of(query));
    }
    std::vector<Projection> found(batch.queries.size());
    Projector projector(grid_, method_, {cloud_.normals, oriented_});
    projector.project(batch.queries, batch.supports, found);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t slot = batch.slots[i - begin];
      use(i, slot == Batch::kNone ? lonely() : found[slot]);
    }
  });
}

/// Calls use(i, projection) for the cloud's points in key order.
template <class Use>
void MlsSurface::for_each_point(Use use) const {
  for_each_projection(
      size(),
      [&](std::size_t i) {
        return Query{cloud_.points[i], {}};
      },
      use);
}

void MlsSurface::project(std::span<const World3> queries, std::span<World3> positions,
                         std::span<Projection> results) const {
  assert(positions.size() == queries.size());
  assert(results.empty() || results.size() == queries.size());
  struct Entry {
    Key key;
    std::size_t index;
  };
  std::vector<Entry> entries;
  entries.reserve(queries.size());
  const auto put = [&](std::size_t i, const Projection& projection) {
    positions[i] = moved(projection.status) ? queries[i] + projection.displacement : queries[i];
    if (!results.empty()) results[i] = projection;
  };
  for (std::size_t i = 0; i < queries.size(); ++i) {
    if (in_reach(queries[i]))
      entries.push_back({encode_key(query_at(queries[i]).position), i});
    else
      put(i, lonely());
  }
  std::ranges::sort(entries, [&](const Entry& a, const Entry& b) {
    return a.key != b.key ? a.key < b.key : queries[a.index] < queries[b.index];
  });
  for_each_projection(
      entries.size(), [&](std::size_t i) { return query_at(queries[entries[i].index]); },
      [&](std::size_t i, const Projection& projection) { put(entries[i].index, projection); });
}

Projected MlsSurface::project(std::span<const World3> queries) const {
  Projected projected{std::vector<World3>(queries.size()), std::vector<Projection>(queries.size())};
  project(queries, projected.positions, projected.results);
  return projected;
}

std::vector<Projection> MlsSurface::project_points() const {
  std::vector<Projection> results(size());
  for_each_projection(
      size(),
      [&](std::size_t i) {
        return Query{cloud_.points[i], {}};
      },
      [&](std::size_t i, const Projection& projection) { results[cloud_.order[i]] = projection; });
  return results;
}

Result<Projected> smooth(std::span<const World3> points, const MlsOptions& options,
                         const CloudNormals& normals) {
  PSS_ASSIGN(const MlsSurface surface, MlsSurface::create(points, options, normals));
  Projected smoothed{{points.begin(), points.end()}, surface.project_points()};
  const Lattice& lattice = surface.lattice();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Projection& result = smoothed.results[i];
    if (moved(result.status))
      smoothed.positions[i] = to_world(lattice, to_index(lattice, points[i])) + result.displacement;
  }
  return smoothed;
}

}  // namespace pss
