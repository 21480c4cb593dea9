#include "bench/peers/cloud.h"

#include <algorithm>
#include <cmath>

#include "io/synth/synth.h"

namespace pss::bench {
namespace {

constexpr int kFloatBits = 24;

/// The finest power of two whose multiples within the surface's bounds are all floats.
double float_step(const Surface& surface) {
  const WorldBox box = bounds(surface);
  double largest = 0;
  for (std::size_t a = 0; a < 3; ++a)
    largest = std::max({largest, std::abs(box.min[a]), std::abs(box.max[a])});
  int exponent = 0;
  std::frexp(1.05 * largest, &exponent);  // with room for noise
  return std::ldexp(1.0, exponent - kFloatBits);
}

bool finite(const World3& p) {
  return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]);
}

}  // namespace

Result<Cloud> make_cloud(SynthOptions options) {
  options.scale = float_step(options.surface);
  PSS_ASSIGN(const std::unique_ptr<Reader> reader, SynthReader::create(options));
  PointBatch batch;
  PSS_TRY(reader->read(options.points, batch));
  return Cloud{{spacing(options), grid(options), std::move(batch.index)}, options.surface};
}

Errors errors_of(const Cloud& cloud, std::span<const World3> results) {
  double sum = 0;
  std::size_t counted = 0;
  for (const World3& p : results) {
    if (!finite(p)) continue;
    const double distance = foot_of(cloud.surface, p).distance / cloud.spacing;
    sum += distance * distance;
    ++counted;
  }
  return {std::sqrt(sum / static_cast<double>(std::max<std::size_t>(counted, 1))),
          cloud.points.size() - std::min(counted, cloud.points.size())};
}

}  // namespace pss::bench
