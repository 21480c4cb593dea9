#include "io/formats/text/text_plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "io/file/file.h"
#include "io/formats/text/text_format.h"

namespace pss {
namespace {

/// A value of the schema and the column it becomes.
struct Offer {
  std::string name;
  TextSource source;
  bool taken = false;
};

std::vector<Offer> offers_of(const Schema& schema) {
  std::vector<Offer> offers;
  for (const Dimension& dimension : schema.dimensions()) {
    for (std::size_t element = 0; element < dimension.count; ++element) {
      const std::string& name = dimension.name;
      offers.push_back({dimension.count == 1 ? name : fmt::format("{}_{}", name, element),
                        {.dimension = dimension, .element = element}});
    }
  }
  return offers;
}

/// What the readers of a kind of file expect.
TextLayout usual_layout(const std::string& extension) {
  TextLayout layout{.extension = extension};
  if (extension == "csv") layout.separator = ',';
  if (extension == "csv" || extension == "txt") layout.header = "";
  layout.counted = extension == "pts";
  return layout;
}

/// The layout of a file made from one that has another extension: its columns and names, but what
/// the new extension stands for.
TextLayout adapted(const TextLayout& source, const std::string& extension) {
  TextLayout layout = usual_layout(extension);
  if (!layout.header && !layout.counted) layout.header = source.header;
  layout.columns = source.columns;
  layout.axes = source.axes;
  return layout;
}

/// A name that can stand in a header line.
std::string as_cell(std::string name, char separator) {
  for (char& c : name)
    if (c < ' ' || c == 127 || c == separator || (separator == ' ' && c == '"')) c = '_';
  return name.empty() ? "unnamed" : name;
}

class Planner {
 public:
  Planner(TextLayout layout, const Schema& schema)
      : wanted_(std::move(layout)), offers_(offers_of(schema)) {}

  TextPlan plan(bool carried);

 private:
  void follow_columns();
  void add(std::string name, TextSource source);
  void add_rest();
  void note_columns();

  TextLayout wanted_;
  std::vector<Offer> offers_;
  TextPlan plan_;
  bool changed_ = false;
};

TextPlan Planner::plan(bool carried) {
  plan_.layout = wanted_;
  plan_.layout.columns.clear();
  follow_columns();
  // Programs read the columns of PTS by their place.
  if (!carried && wanted_.extension == "pts")
    for (const std::string_view first : {"Intensity", "Red", "Green", "Blue"})
      if (const auto offer = std::ranges::find(offers_, first, &Offer::name);
          offer != offers_.end() && !offer->taken) {
        offer->taken = true;
        add(offer->name, offer->source);
      }
  add_rest();
  note_columns();
  return std::move(plan_);
}

/// The columns of the layout, as far as the schema still has them.
void Planner::follow_columns() {
  for (std::size_t i = 0; i < wanted_.columns.size(); ++i) {
    const std::string& name = wanted_.columns[i];
    if (const auto axis = wanted_.axis(i)) {
      plan_.layout.axes[*axis] = plan_.layout.columns.size();
      add(name, {.axis = axis});
      continue;
    }
    const auto offer = std::ranges::find(offers_, name, &Offer::name);
    if (offer == offers_.end()) {
      plan_.notes.push_back(fmt::format("column '{}' is dropped", name));
      changed_ = true;
      continue;
    }
    offer->taken = true;
    add(name, offer->source);
  }
}

void Planner::add(std::string name, TextSource source) {
  plan_.layout.columns.push_back(as_cell(std::move(name), wanted_.separator));
  plan_.sources.push_back(std::move(source));
}

void Planner::add_rest() {
  for (Offer& offer : offers_) {
    if (offer.taken) continue;
    add(offer.name, offer.source);
    changed_ = true;
  }
}

/// Says what the file itself does not.
void Planner::note_columns() {
  if (!changed_ || plan_.layout.header) return;
  plan_.notes.push_back(fmt::format("the columns are {}", fmt::join(plan_.layout.columns, " ")));
}

}  // namespace

Result<TextPlan> plan_text(const std::string& path, const WriteOptions& options) {
  const std::string extension = extension_of(path);
  if (!options.carry || options.carry->family != kTextFormat.family)
    return Planner(usual_layout(extension), options.schema).plan(false);
  PSS_ASSIGN(TextLayout source, unpack_text_layout(options.carry->head));
  const bool same = source.extension == extension;
  return Planner(same ? source : adapted(source, extension), options.schema).plan(true);
}

}  // namespace pss
