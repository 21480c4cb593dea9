#include "stream/widths/widths_json.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace pss {
namespace {

using nlohmann::ordered_json;

ordered_json spacing_json(const std::optional<Spacing>& spacing) {
  if (!spacing) return {};
  return {{"spacing", spacing->spacing},   {"d16_median", spacing->d16},
          {"d16_p10", spacing->d16_low},   {"d16_p90", spacing->d16_high},
          {"varying", spacing->varying()}, {"sample", spacing->sample},
          {"twins", spacing->twins}};
}

std::optional<Spacing> spacing_from(const ordered_json& j) {
  if (!j.is_object()) return std::nullopt;
  return Spacing{j.value("spacing", 0.0),           j.value("d16_median", 0.0),
                 j.value("d16_p10", 0.0),           j.value("d16_p90", 0.0),
                 j.value("sample", std::size_t{0}), j.value("twins", 1.0)};
}

ordered_json trial_json(const WidthTrial& trial) {
  return {{"h", trial.width},
          {"known", trial.known},
          {"usable", trial.usable},
          {"residual", trial.residual},
          {"bend", trial.bend},
          {"change", trial.change},
          {"noise_change", trial.noise_change}};
}

WidthTrial trial_from(const ordered_json& j) {
  return {j.value("h", 0.0),           j.value("known", false), j.value("usable", 0.0),
          j.value("residual", 0.0),    j.value("bend", 0.0),    j.value("change", 0.0),
          j.value("noise_change", 0.0)};
}

ordered_json noise_json(const std::optional<Noise>& noise, const WidthChoice& choice) {
  if (!noise) return {};
  ordered_json trials = ordered_json::array();
  for (const WidthTrial& trial : noise->trials) trials.push_back(trial_json(trial));
  return {{"sigma", noise->sigma},
          {"surface", noise->first >= 0},
          {"other_sheet", noise->apart},
          {"sample", noise->sample},
          {"h_per_spacing", choice.multiple},
          {"limit", word_for(choice.limit)},
          {"expected", choice.error},
          {"first", noise->first},
          {"trials", std::move(trials)}};
}

void read_noise(const ordered_json& j, ChosenWidths& widths) {
  if (!j.is_object()) return;
  Noise noise;
  noise.sigma = j.value("sigma", 0.0);
  noise.apart = j.value("other_sheet", 0.0);
  noise.sample = j.value("sample", std::size_t{0});
  noise.first = j.value("first", -1);
  for (const ordered_json& trial : j.value("trials", ordered_json::array()))
    noise.trials.push_back(trial_from(trial));
  widths.noise = std::move(noise);
  widths.choice.multiple = j.value("h_per_spacing", kNarrowest);
  widths.choice.error = j.value("expected", 0.0);
  const std::string word = j.value("limit", "");
  for (const WidthLimit limit : kWidthLimits)
    if (word == word_for(limit)) widths.choice.limit = limit;
}

}  // namespace

ordered_json widths_json(const ChosenWidths& widths) {
  return {{"radius", widths.radius},
          {"h", widths.h},
          {"knn", widths.nearest},
          {"radius_per_distance", widths.factor},
          {"cap", widths.cap},
          {"typical", widths.typical},
          {"neighbours", widths.neighbours},
          {"why", widths.why},
          {"spacing", spacing_json(widths.spacing)},
          {"noise", noise_json(widths.noise, widths.choice)}};
}

ChosenWidths widths_from_json(const ordered_json& json) {
  ChosenWidths widths;
  widths.radius = json.value("radius", 0.0);
  widths.h = json.value("h", 0.0);
  widths.nearest = json.value("knn", 0);
  widths.factor = json.value("radius_per_distance", 1.0);
  widths.cap = json.value("cap", 0.0);
  widths.typical = json.value("typical", 0.0);
  widths.neighbours = json.value("neighbours", 0.0);
  widths.why = json.value("why", "");
  widths.spacing = spacing_from(json.value("spacing", ordered_json()));
  read_noise(json.value("noise", ordered_json()), widths);
  return widths;
}

}  // namespace pss
