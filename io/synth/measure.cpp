#include "io/synth/measure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "core/status.h"

namespace pss {
namespace {

constexpr std::size_t kBatch = 65536;
constexpr std::size_t kGrain = 1024;

/// What one point contributes; written by any thread, summed in order by one.
struct Sample {
  bool finite = false;
  bool described = false;  ///< whether the attributes of the point describe the surface
  double distance = 0;
  double normal = 0;
  double mean_curvature = 0;
  double gaussian_curvature = 0;
};

/// The attributes of a file that can be compared with the truth.
struct Described {
  std::array<std::optional<Dimension>, 3> normal;
  std::optional<Dimension> mean_curvature, gaussian_curvature, status;

  bool has_normal() const { return normal[0] && normal[1] && normal[2]; }
};

Described find_attributes(const Schema& schema) {
  constexpr std::array kLong{"NormalX", "NormalY", "NormalZ"};
  constexpr std::array kShort{"nx", "ny", "nz"};
  Described found;
  for (std::size_t a = 0; a < 3; ++a) {
    found.normal[a] = schema.dimension(kLong[a]);
    if (!found.normal[a]) found.normal[a] = schema.dimension(kShort[a]);
  }
  found.mean_curvature = schema.dimension("MeanCurvature");
  found.gaussian_curvature = schema.dimension("GaussianCurvature");
  found.status = schema.dimension("Status");
  return found;
}

double dot(const World3& a, const World3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The angle between two lines; precise near zero, where the arc cosine is not.
double line_angle(const World3& a, const World3& b) {
  const World3 cross{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                     a[0] * b[1] - a[1] * b[0]};
  return std::atan2(std::sqrt(dot(cross, cross)), std::abs(dot(a, b)));
}

/// 1 or -1, so that times this the largest component is positive.
double canonical_sign(const World3& n) {
  const auto largest =
      std::ranges::max_element(n, {}, [](double component) { return std::abs(component); });
  return *largest < 0 ? -1 : 1;
}

/// Compares points of a batch with the truth.
class Comparison {
 public:
  Comparison(const CloudHeader& header, const SynthOptions& truth)
      : surface_(truth.surface),
        grid_(header.grid),
        row_size_(header.schema.row_size()),
        attributes_(find_attributes(header.schema)) {
    // Lengths from the surface's own origin: a large offset costs no digits.
    for (std::size_t a = 0; a < 3; ++a)
      shift_[a] = (grid_ ? grid_->origin[a] : 0) - truth.offset[a];
  }

  const Described& attributes() const { return attributes_; }

  Sample sample(const PointBatch& batch, std::size_t point) const {
    const World3 place = local(batch, point);
    Sample sample;
    sample.finite = std::ranges::all_of(place, [](double x) { return std::isfinite(x); });
    if (!sample.finite) return sample;
    const Foot foot = foot_of(surface_, place);
    sample.distance = foot.distance;
    sample.finite = std::isfinite(foot.distance);  // it overflows where the place nearly does
    if (!sample.finite) return sample;
    if (row_size_ > 0) describe(foot, &batch.rows[point * row_size_], sample);
    return sample;
  }

 private:
  World3 local(const PointBatch& batch, std::size_t point) const {
    World3 place = shift_;
    for (std::size_t a = 0; a < 3; ++a)
      place[a] += batch.index.empty()
                      ? batch.world[point][a]
                      : grid_->scale[a] * static_cast<double>(batch.index[point][a]);
    return place;
  }

  void describe(const Foot& foot, const std::byte* row, Sample& sample) const {
    if (attributes_.status && !moved(status_of(row))) return;
    double sign = canonical_sign(foot.normal);
    if (attributes_.has_normal()) {
      World3 normal;
      for (std::size_t a = 0; a < 3; ++a) normal[a] = read_value(*attributes_.normal[a], row);
      if (!(dot(normal, normal) > 0)) return;
      sample.normal = line_angle(normal, foot.normal);
      sign = dot(normal, foot.normal) < 0 ? -1 : 1;
    }
    sample.described = true;
    if (attributes_.mean_curvature)
      sample.mean_curvature =
          read_value(*attributes_.mean_curvature, row) - sign * foot.mean_curvature;
    if (attributes_.gaussian_curvature)
      sample.gaussian_curvature =
          read_value(*attributes_.gaussian_curvature, row) - foot.gaussian_curvature;
  }

  Status status_of(const std::byte* row) const {
    const auto code = static_cast<int>(read_value(*attributes_.status, row));
    return static_cast<Status>(code & ~int{kSecondSheetFlag});
  }

  const Surface& surface_;
  std::optional<Lattice> grid_;
  std::size_t row_size_;
  Described attributes_;
  World3 shift_{};
};

Measurement empty_measurement(const Described& attributes) {
  Measurement measurement;
  if (attributes.has_normal()) measurement.normal.emplace();
  if (attributes.mean_curvature) measurement.mean_curvature.emplace();
  if (attributes.gaussian_curvature) measurement.gaussian_curvature.emplace();
  return measurement;
}

void add_if(std::optional<Magnitudes>& to, double value) {
  if (to && std::isfinite(value)) to->add(value);
}

void add(const Sample& sample, Measurement& to) {
  if (!sample.finite) {
    ++to.not_finite;
    return;
  }
  to.distance.add(sample.distance);
  if (!sample.described) return;
  add_if(to.normal, sample.normal);
  add_if(to.mean_curvature, sample.mean_curvature);
  add_if(to.gaussian_curvature, sample.gaussian_curvature);
}

}  // namespace

Result<Measurement> measure(Reader& reader, const SynthOptions& truth, Monitor& monitor) {
  const Comparison comparison(reader.header(), truth);
  Measurement measurement = empty_measurement(comparison.attributes());
  std::vector<Sample> samples;
  PointBatch batch;
  monitor.begin("measure", reader.header().count.value_or(0));
  while (true) {
    if (monitor.stopping()) return Error{Fault::kInterrupted, "the measurement was interrupted"};
    PSS_TRY(reader.read(kBatch, batch));
    if (batch.size() == 0) return measurement;
    samples.resize(batch.size());
    parallel_for(batch.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) samples[i] = comparison.sample(batch, i);
    });
    for (const Sample& sample : samples) add(sample, measurement);
    monitor.advance(batch.size());
  }
}

}  // namespace pss
