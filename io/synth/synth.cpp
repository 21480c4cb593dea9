#include "io/synth/synth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "core/parallel.h"
#include "io/file/bytes.h"
#include "io/formats/las/las_schema.h"
#include "io/synth/synth_random.h"

namespace pss {
namespace {

constexpr std::size_t kChunk = 1024;  // records made at once by one thread
constexpr std::uint64_t kLargestLegacyCount = 0xffffffff;
constexpr double kClassGround = 2;
constexpr double kClassUnclassified = 1;
constexpr double kSecondsPerRecord = 1e-6;
// Added to the seed, so that what is random about a record is independent.
constexpr std::uint64_t kIntensityStream = std::uint64_t{1} << 62;
constexpr std::uint64_t kJitterStream = std::uint64_t{2} << 62;

/// Two unit vectors perpendicular to a unit vector and to each other.
/// Source: Duff et al., "Building an orthonormal basis, revisited", 2017.
std::array<World3, 2> tangents(const World3& n) {
  const double sign = n[2] < 0 ? -1 : 1;
  const double a = -1 / (sign + n[2]);
  const double b = n[0] * n[1] * a;
  return {World3{1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]},
          World3{b, sign + n[1] * n[1] * a, -n[1]}};
}

WorldBox noisy_bounds(const SynthOptions& options) {
  WorldBox box = bounds(options.surface);
  const double step = grid(options).scale[0];
  // A scan's own spacing, where it is sparsest, over the spacing of all scans together.
  const double sparse =
      std::sqrt(std::max(1.0, kCoverage * options.scans) * (1 + (options.corner_density - 1) / 12));
  const double margin =
      (kLargestNormal * options.noise + sparse * options.jitter) * spacing(options) + step;
  for (std::size_t a = 0; a < 3; ++a) {
    box.min[a] += options.offset[a] - margin;
    box.max[a] += options.offset[a] + margin;
  }
  return box;
}

Schema synth_schema(const SynthOptions& options) {
  const std::uint8_t legacy = options.time ? 1 : 0;
  Schema schema = las_standard_schema(options.points > kLargestLegacyCount ? 6 : legacy);
  if (!options.truth) return schema;
  for (const char* name : {"TrueX", "TrueY", "TrueZ", "TrueDistance"})
    schema.add({name, Type::kFloat64, 1, 1, 0, {}});
  return schema;
}

}  // namespace

Result<std::unique_ptr<Reader>> SynthReader::create(const SynthOptions& options) {
  PSS_TRY(check(options));
  return std::unique_ptr<Reader>(new SynthReader(options));
}

SynthReader::SynthReader(const SynthOptions& options)
    : options_(options),
      plan_(options),
      sigma_(options.noise * spacing(options)),
      jitter_(options.jitter * std::sqrt(area(options.surface) / 2)) {
  make_header();
  make_template_row();
}

void SynthReader::make_header() {
  header_.path = std::string("synth ") + shape_name(options_.surface);
  header_.count = options_.points;
  header_.grid = grid(options_);
  if (options_.points > 0) header_.bounds = noisy_bounds(options_);
  header_.schema = synth_schema(options_);
}

void SynthReader::make_template_row() {
  const Schema& schema = header_.schema;
  const auto position = [&](std::string_view name) -> std::optional<std::size_t> {
    const auto dimension = schema.dimension(name);
    if (!dimension) return std::nullopt;
    return dimension->position;
  };
  columns_ = {*position("Intensity"), *position("PointSourceId"), position("GpsTime"),
              position("TrueX")};
  row_.assign(schema.row_size(), std::byte{0});
  const bool ground = std::holds_alternative<Terrain>(options_.surface);
  write_value(*schema.dimension("ReturnNumber"), row_.data(), 1);
  write_value(*schema.dimension("NumberOfReturns"), row_.data(), 1);
  write_value(*schema.dimension("Classification"), row_.data(),
              ground ? kClassGround : kClassUnclassified);
}

Result<void> SynthReader::read(std::size_t max, PointBatch& batch) {
  const auto count =
      static_cast<std::size_t>(std::min<std::uint64_t>(max, options_.points - next_));
  batch.first_record = next_;
  batch.world.clear();
  batch.index.resize(count);
  batch.rows.resize(count * row_.size());
  parallel_for(count, kChunk, [&](std::size_t begin, std::size_t end) {
    for (std::size_t at = begin; at < end; at += kChunk)
      generate(next_, at, std::min(end, at + kChunk), batch);
  });
  next_ += count;
  return {};
}

Result<void> SynthReader::seek(std::uint64_t record) {
  next_ = std::min(record, options_.points);
  return {};
}

void SynthReader::generate(std::uint64_t first, std::size_t begin, std::size_t end,
                           PointBatch& batch) const {
  std::array<Place, kChunk> places;
  plan_.places(first + begin, std::span(places).first(end - begin));
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint64_t record = first + i;
    const SurfacePoint point = sample(record, places[i - begin]);
    const double distance = sigma_ > 0 ? sigma_ * random_normal(options_.seed, record) : 0;
    for (std::size_t a = 0; a < 3; ++a)
      batch.index[i][a] =
          std::llrint((point.position[a] + distance * point.normal[a]) / header_.grid->scale[a]);
    fill_row(record, point.position, distance, &batch.rows[i * row_.size()]);
  }
}

SurfacePoint SynthReader::sample(std::uint64_t record, const Place& place) const {
  const SurfacePoint point = surface_point(options_.surface, place.u, place.v);
  if (jitter_ == 0) return point;
  const std::uint64_t bits = random_bits(options_.seed + kJitterStream, record);
  const double a = jitter_ * place.spacing * (2 * unit_fraction(bits) - 1);
  const double b = jitter_ * place.spacing * (2 * unit_fraction(mix_bits(bits)) - 1);
  const auto [along, across] = tangents(point.normal);
  World3 aside = point.position;
  for (std::size_t i = 0; i < 3; ++i) aside[i] += a * along[i] + b * across[i];
  return settle(options_.surface, aside);
}

void SynthReader::fill_row(std::uint64_t record, const World3& place, double distance,
                           std::byte* row) const {
  const std::span<std::byte> out(row, row_.size());
  std::ranges::copy(row_, row);
  const auto scan = static_cast<std::uint16_t>(plan_.scan_of(record) + 1);
  store_le(out, columns_.intensity,
           static_cast<std::uint16_t>(random_bits(options_.seed + kIntensityStream, record) >> 48));
  store_le(out, columns_.source, scan);
  if (columns_.time) store_le(out, *columns_.time, kSecondsPerRecord * static_cast<double>(record));
  if (!columns_.truth) return;
  for (std::size_t a = 0; a < 3; ++a)
    store_le(out, *columns_.truth + 8 * a, options_.offset[a] + place[a]);
  store_le(out, *columns_.truth + 24, distance);
}

}  // namespace pss
