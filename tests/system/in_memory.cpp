// Smooths a LAS file all in memory: what the out-of-core program's files must equal.
//
// in_memory IN.las OUT.las OPERATOR h|knn WIDTH [CAP]: the library of core alone, without store,
// tile, halo or scheduler, on one thread, in the narrowest vector target. The coordinates go onto
// the lattice of results and from there into the file, as docs/jobs.md has it; all outputs.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <numeric>
#include <ranges>
#include <span>
#include <string>
#include <vector>

#include "core/mls_surface.h"
#include "core/morton.h"
#include "core/parallel.h"
#include "core/simd/targets.h"
#include "io/open.h"
#include "stream/passes/outputs.h"

namespace pss {
namespace {

constexpr int kRefinement = 256;  // of the lattice of results, where its range allows

/// All points of a file in the order of a store: by key, then by the bytes of the row.
struct Scan {
  CloudHeader header;
  std::vector<Index3> index;
  std::vector<std::byte> rows;

  std::span<const std::byte> row(std::size_t i) const {
    const std::size_t size = header.schema.row_size();
    return std::span(rows).subspan(i * size, size);
  }
};

std::vector<std::size_t> store_order(const Scan& scan) {
  std::vector<std::size_t> order(scan.index.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    const Key left = encode_key(scan.index[a]);
    const Key right = encode_key(scan.index[b]);
    if (left != right) return left < right;
    return std::ranges::lexicographical_compare(scan.row(a), scan.row(b));
  });
  return order;
}

Result<Scan> read_scan(const std::string& path) {
  PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_reader(path));
  Scan scan{reader->header(), {}, {}};
  PointBatch batch;
  do {
    PSS_TRY(reader->read(65536, batch));
    scan.index.insert(scan.index.end(), batch.index.begin(), batch.index.end());
    scan.rows.insert(scan.rows.end(), batch.rows.begin(), batch.rows.end());
  } while (batch.size() > 0);
  return scan;
}

Result<MlsSurface> surface_of(const Scan& scan, std::span<const std::string> words) {
  MlsOptions options;
  for (const MlsOperator op : kMlsOperators)
    if (name_of(op) == words[0]) options.method.op = op;
  options.method.precision = Precision::kSingle;
  options.lattice = scan.header.grid;
  const double width = std::atof(words[2].c_str());
  if (words[1] == "knn") {
    options.knn = static_cast<int>(width);
    options.radius = std::atof(words[3].c_str());
  } else {
    options.h = width;
  }
  std::vector<World3> points;
  for (const Index3& i : scan.index) points.push_back(to_world(*scan.header.grid, i));
  return MlsSurface::create(points, options);
}

Index3 destination(const Projection& projection, const Index3& own, const Lattice& refined) {
  Index3 place{};
  for (std::size_t a = 0; a < 3; ++a)
    place[a] =
        kRefinement * own[a] +
        (moved(projection.status) ? std::llrint(projection.displacement[a] / refined.scale[a]) : 0);
  return place;
}

Result<void> write_scan(const Scan& scan, const std::vector<Projection>& results,
                        const std::string& path) {
  WriteOptions options;
  options.schema = scan.header.schema;
  PSS_ASSIGN(const OutputColumns columns, OutputColumns::add_to(options.schema, kAllOutputs));
  options.grid = scan.header.grid;
  for (double& scale : options.grid->scale) scale /= kRefinement;
  options.count = results.size();
  options.carry = scan.header.carry;
  options.scale = scan.header.grid->scale;
  options.offset = scan.header.grid->origin;
  PSS_ASSIGN(const std::unique_ptr<Writer> writer, create_writer(path, options));
  PointBatch batch;
  batch.rows.resize(results.size() * options.schema.row_size());
  for (std::size_t k = 0; const std::size_t i : store_order(scan)) {
    batch.index.push_back(destination(results[i], scan.index[i], *options.grid));
    std::byte* row = &batch.rows[k++ * options.schema.row_size()];
    std::ranges::copy(scan.row(i), row);
    columns.write(results[i], row);
  }
  PSS_TRY(writer->write(batch));
  return writer->finish();
}

Result<void> run(std::span<const std::string> words) {
  const simd::ForcedTarget narrowest(simd::targets().back());
  const ThreadLimit one(1);
  PSS_ASSIGN(const Scan scan, read_scan(words[0]));
  PSS_ASSIGN(const MlsSurface surface, surface_of(scan, words.subspan(2)));
  return write_scan(scan, surface.project_points(), words[1]);
}

}  // namespace
}  // namespace pss

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  if (words.size() < 5) return 2;
  const pss::Result<void> result = pss::run(words);
  if (!result) fmt::print(stderr, "in_memory: {}\n", result.error().message);
  return result ? 0 : 1;
}
