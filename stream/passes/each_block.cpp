#include "stream/passes/each_block.h"

#include <optional>
#include <utility>
#include <vector>

#include "core/parallel.h"

namespace pss {

Result<void> for_each_block(std::size_t count,
                            const std::function<Result<void>(std::size_t)>& work) {
  std::vector<std::optional<Error>> errors(count);
  parallel_for(count, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t b = begin; b < end; ++b)
      if (Result<void> done = work(b); !done) errors[b] = std::move(done).error();
  });
  for (std::optional<Error>& error : errors)
    if (error) return *std::move(error);
  return {};
}

}  // namespace pss
