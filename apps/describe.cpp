#include "apps/describe.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "apps/progress_view.h"
#include "io/formats/table.h"
#include "io/points/position_survey.h"

namespace pss {

namespace {

using Json = nlohmann::ordered_json;

Json describe_bounds(const WorldBox& box) { return {{"min", box.min}, {"max", box.max}}; }

Json describe_dimension(const Dimension& dimension) {
  Json row{{"name", dimension.name}, {"type", type_name(dimension.type)}};
  if (dimension.width > 0) row["bits"] = dimension.width;
  if (dimension.count > 1) row["count"] = dimension.count;
  if (dimension.scale != 1) row["scale"] = dimension.scale;
  if (dimension.offset != 0) row["offset"] = dimension.offset;
  return row;
}

Json describe_schema(const Schema& schema) {
  Json rows = Json::array();
  for (const Dimension& dimension : schema.dimensions())
    rows.push_back(describe_dimension(dimension));
  return rows;
}

void describe_grid(Json& facts, const Lattice& grid) {
  facts["scale"] = grid.scale;
  facts["offset"] = grid.origin;
}

Json as_json(std::uint64_t number) { return number; }
Json as_json(const std::string& text) { return text; }
Json as_json(const std::vector<FilePart>& parts) {
  Json rows = Json::array();
  for (const FilePart& part : parts)
    rows.push_back({{"name", part.name}, {"type", part.type}, {"bytes", part.bytes}});
  return rows;
}

/// What the header says beyond what those of all formats say.
void describe_format(Json& facts, const CloudHeader& header) {
  const Format* format = find_format(header.format);
  if (!format || !format->facts) return;
  for (const Fact& fact : format->facts(header.carry))
    facts[fact.name] = std::visit([](const auto& value) { return as_json(value); }, fact.value);
}

/// A JSON text as a value; what is none, as a string.
Json parsed(const std::string& text) {
  const Json value = Json::parse(text, nullptr, false);
  return value.is_discarded() ? Json(text) : value;
}

/// The coordinate system of the first input that has one; the others have none or the same.
Result<Json> describe_crs(const InputTable& inputs) {
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    PSS_ASSIGN(const std::string crs, inputs.crs(i));
    if (!crs.empty()) return Json(crs);
  }
  return Json();
}

Result<Json> input_paths(const InputTable& inputs) {
  Json paths = Json::array();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    PSS_ASSIGN(const InputFacts facts, inputs.facts(i));
    paths.push_back(facts.record.path);
  }
  return paths;
}

/// What is known of the inputs once the store is complete.
Result<void> describe_inputs(Json& facts, const Store& store) {
  if (!store.complete() || store.header().inputs.count == 0) return {};
  PSS_ASSIGN(const InputTable inputs, store.inputs());
  PSS_ASSIGN(const InputFacts first, inputs.facts(0));
  facts["source_format"] = first.format;
  PSS_ASSIGN(facts["crs"], describe_crs(inputs));
  PSS_ASSIGN(facts["inputs"], input_paths(inputs));
  return {};
}

bool is_table(const Json& value) {
  return value.is_array() && !value.empty() && value.front().is_object();
}

std::string as_text(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_unsigned()) return grouped(value.get<std::uint64_t>());
  if (value.is_number_float()) return fmt::format("{:.12g}", value.get<double>());
  if (value.is_null()) return "not given";
  if (!value.is_structured()) return value.dump();
  if (value.empty()) return "none";
  std::vector<std::string> parts;
  for (const auto& [key, part] : value.items())
    parts.push_back(value.is_object() ? key + " " + as_text(part) : as_text(part));
  return fmt::format("{}", fmt::join(parts, value.is_object() ? ", " : "  "));
}

/// "name  type  the rest of it".
std::string table_row(const Json& row) {
  std::vector<std::string> rest;
  for (const auto& [key, value] : row.items())
    if (key != "name" && key != "type") rest.push_back(key + " " + as_text(value));
  std::string line = fmt::format("    {:<28} {:<8} {}", as_text(row.value("name", Json(""))),
                                 as_text(row.value("type", Json(""))), fmt::join(rest, ", "));
  return line.substr(0, line.find_last_not_of(' ') + 1) + '\n';
}

/// A fact on one line; a long text, such as a coordinate system, is cut.
std::string fact_line(const std::string& key, const Json& value) {
  constexpr std::size_t kLongest = 76;
  std::string text = as_text(value);
  text = text.substr(0, text.find('\n'));
  if (value.is_string() && text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return fmt::format("  {:<16} {}\n", key, text);
}

}  // namespace

Result<Json> describe_file(Reader& reader, bool scan) {
  const CloudHeader& header = reader.header();
  Json facts{{"path", header.path}, {"kind", "file"}, {"format", header.format}};
  facts["points"] = header.count ? Json(*header.count) : Json();
  facts["bounds"] = header.bounds ? describe_bounds(*header.bounds) : Json();
  if (scan) {
    Monitor unwatched;
    PSS_ASSIGN(const Extent all,
               read_positions(reader, {}, unwatched, [](std::uint64_t, const World3&) {}));
    facts["points_read"] = all.records;
    facts["bounds_read"] = all.bounds.empty() ? Json() : describe_bounds(all.bounds);
  }
  if (header.grid) describe_grid(facts, *header.grid);
  facts["crs"] = header.crs.empty() ? Json() : Json(header.crs);
  describe_format(facts, header);
  facts["attributes"] = describe_schema(header.schema);
  if (!header.warnings.empty()) facts["warnings"] = header.warnings;
  return facts;
}

Result<Json> describe_store(const Store& store) {
  const StoreHeader& header = store.header();
  Json facts{{"path", store.path()},
             {"kind", "store"},
             {"producer", store.producer()},
             {"complete", store.complete()},
             {"points", store.points()},
             {"tiles", store.tiles().size()},
             {"tile_points", header.tile_points},
             {"order", header.ordered ? "key" : "of its source"}};
  IndexBox box;
  for (const TileInfo& tile : store.tiles()) box.add(tile.box);
  facts["bounds"] = box.empty() ? Json()
                                : describe_bounds({.min = to_world(header.lattice, box.min),
                                                   .max = to_world(header.lattice, box.max)});
  facts["lattice"] = {{"step", header.lattice.scale}, {"origin", header.lattice.origin}};
  if (header.grid) describe_grid(facts, *header.grid);
  facts["bytes_on_disk"] = store.bytes_on_disk();
  if (store.points() > 0)
    facts["bytes_per_point"] = std::round(100 * static_cast<double>(store.bytes_on_disk()) /
                                          static_cast<double>(store.points())) /
                               100;
  facts["attributes"] = describe_schema(header.schema);
  PSS_TRY(describe_inputs(facts, store));
  if (!header.parameters.empty()) facts["parameters"] = parsed(header.parameters);
  if (!store.summary().empty()) facts["summary"] = parsed(store.summary());
  return facts;
}

Json describe_job(const std::string& work_dir, const JobState& state) {
  Json facts{{"path", work_dir},
             {"kind", "job"},
             {"command", state.command},
             {"output", state.output},
             {"stage", state.stage}};
  if (state.stage != "complete") {  // then the work is gone
    facts["tiles_done"] = state.tiles_done;
    facts["tiles"] = state.tiles > 0 ? Json(state.tiles) : Json();
  }
  if (state.points > 0) facts["points"] = state.points;
  if (!state.spoiled.empty()) facts["ended_because"] = state.spoiled;
  facts["running"] = state.holder ? Json(*state.holder) : Json("no");
  facts["inputs"] = state.inputs;
  facts["parameters"] = parsed(state.parameters);
  return facts;
}

std::string as_table(const Json& facts) {
  std::string out;
  for (const auto& [key, value] : facts.items()) {
    if (key == "path")
      out += as_text(value) + "\n";
    else if (!is_table(value))
      out += fact_line(key, value);
    else {
      out += fmt::format("  {}\n", key);
      for (const Json& row : value) out += table_row(row);
    }
  }
  return out;
}

}  // namespace pss
