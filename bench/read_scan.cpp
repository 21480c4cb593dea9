#include "bench/read_scan.h"

#include <memory>

#include "io/open.h"

namespace pss::bench {

Result<SortedCloud> read_scan(const std::string& path) {
  PSS_ASSIGN(const std::unique_ptr<Reader> reader, open_reader(path));
  const std::optional<Lattice>& grid = reader->header().grid;
  std::vector<World3> world;
  PointBatch batch;
  do {
    PSS_TRY(reader->read(1 << 16, batch));
    for (const Index3& index : batch.index) world.push_back(to_world(*grid, index));
    world.insert(world.end(), batch.world.begin(), batch.world.end());
  } while (batch.size() > 0);
  return sort_cloud(world, {}, grid);
}

std::string file_name(const std::string& path) { return path.substr(path.rfind('/') + 1); }

}  // namespace pss::bench
