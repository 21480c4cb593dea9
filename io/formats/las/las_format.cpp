#include "io/formats/las/las_format.h"

#include <array>

#include "io/formats/las/las_facts.h"
#include "io/formats/las/las_header.h"
#include "io/formats/las/las_reader.h"
#include "io/formats/las/las_writer.h"

namespace pss {
namespace {

constexpr std::array<std::string_view, 1> kExtensions{"las"};

Likeness probe(std::string_view start) {
  return is_las(std::as_bytes(std::span(start))) ? Likeness::kCertain : Likeness::kNone;
}

}  // namespace

constinit const Format kLasFormat{.name = "LAS",
                                  .extensions = kExtensions,
                                  .probe = probe,
                                  .open = open_las_holding,
                                  .create = create_las,
                                  .plan = plan_las_grid,
                                  .integer_grid = true,
                                  .family = "LAS",
                                  .facts = las_facts};

}  // namespace pss
