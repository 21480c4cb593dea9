#include "stream/jobs/job_kind.h"

#include <nlohmann/json.hpp>

#include "stream/jobs/shallow_json.h"

namespace pss {

using nlohmann::ordered_json;

StoreShape shape_of(const StoreHeader& header) {
  return {header.lattice, header.schema.row_size()};
}

StoreShape shape_of(const Operator& op) {
  StoreShape shape = shape_of(op.result_header());
  shape.columns_alone = op.columns_alone();
  return shape;
}

std::string owned_by(const std::string& identity, ordered_json parameters) {
  parameters["job"] = identity;
  return parameters.dump();
}

std::string owner_in(const std::string& parameters) {
  const auto j = parse_shallow<ordered_json>(parameters);
  const auto found = j.is_object() ? j.find("job") : j.end();
  return found != j.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace pss
