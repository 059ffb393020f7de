#include "axis_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace touchstone::axis {

std::string unit_of_term(AxisTermKind term, const AxisWords& words) {
  switch (term) {
    case AxisTermKind::viscous_friction:
      return fmt::format("{} s/{}", words.load_unit, words.place_unit);
    case AxisTermKind::inertia:
      return fmt::format("{} s^2/{}", words.load_unit, words.place_unit);
    case AxisTermKind::relaxation:
      return fmt::format("{}/{}", words.load_unit, words.place_unit);
    case AxisTermKind::relaxation_time:
      return "s";
    case AxisTermKind::reversal_width:
      return words.place_unit;
    case AxisTermKind::dry_friction:
    case AxisTermKind::friction_over_place:
      break;
  }
  return words.load_unit;
}

namespace {

const char* reversal_name(AxisReversal reversal) {
  switch (reversal) {
    case AxisReversal::at_once:
      return "at once";
    case AxisReversal::presliding:
      return "presliding";
    case AxisReversal::backlash:
      return "backlash";
    case AxisReversal::undecided:
      break;
  }
  return "undecided";
}

std::string reversal_words(AxisReversal reversal) {
  if (reversal == AxisReversal::presliding) return " (presliding: friction turns in proportion to the way)";
  if (reversal == AxisReversal::backlash) return " (backlash: no friction until the gap is crossed)";
  return " (presliding or backlash)";
}

}  // namespace

std::vector<std::string> axis_remarks(const AxisFit& fit, const AxisWords& words,
                                      const std::optional<AxisFloor>& floor) {
  std::vector<std::string> remarks;
  if (fit.reversed) {
    remarks.push_back(
        fmt::format("the {} drives the motion instead of resisting it (friction would be {:.3g} {}): is "
                    "its sign reversed? give --flip-force",
                    words.load, fit.dry_alone, words.load_unit));
  }
  if (fit.gives_work && !fit.reversed) {
    remarks.push_back(
        fmt::format("the loop gives more work than it takes, which no passive object does: there and back are in the "
                    "wrong order in the file or its map, the {} is late, or it drifts",
                    words.load));
  }
  if (fit.friction_undecided) {
    remarks.push_back(fmt::format(
        "dry and viscous friction cannot be told apart here: the speed is {:.3g} to {:.3g} {}/s; dry alone, {:.4g} {}, "
        "leaves {:.4g} {}, viscous alone, {:.4g} {}, leaves {:.4g} {}. Record at two speeds, one three times the other",
        fit.slowest, fit.fastest, words.place_unit, fit.dry_alone, words.load_unit, fit.dry_left, words.load_unit,
        fit.viscous_alone, unit_of_term(AxisTermKind::viscous_friction, words), fit.viscous_left, words.load_unit));
  }
  if (fit.reversal == AxisReversal::undecided) {
    remarks.push_back(fmt::format(
        "presliding and backlash cannot be told apart here: both fit the {} within the way that a reversal takes. "
        "Record slow reversals of small amplitude",
        words.load));
  }
  if (words.indentation && fit.reversals == 1) {
    remarks.push_back(fmt::format(
        "one way there and one back: relaxation, friction, adhesion and damage all open the loop in the same way, and "
        "what is named above may be any of them. Record two speeds and a hold"));
  }
  if (floor) {
    remarks.push_back(
        fit.after > floor->within
            ? fmt::format("the held-out error is {:.3g} times what one recording does not repeat, {:.4g} {}",
                          fit.after / floor->value, floor->value, words.load_unit)
            : fmt::format("the held-out error is within what one recording does not repeat, {:.4g} {}", floor->value,
                          words.load_unit));
  }
  return remarks;
}

std::string axis_text(const AxisFit& fit, const AxisWords& words, const std::optional<AxisFloor>& floor) {
  std::string text = axis_values(fit, words);
  for (const std::string& remark : axis_remarks(fit, words, floor)) text += remark + "\n";
  return text;
}

std::string axis_values(const AxisFit& fit, const AxisWords& words) {
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += fmt::format("{:26} {}\n", name, value);
  };
  for (const AxisTerm& term : fit.terms) {
    line(to_string(term.kind),
         fmt::format("{:.4g}{} {}", term.value,
                     term.standard_error ? fmt::format(" +- {:.2g}", *term.standard_error) : "",
                     unit_of_term(term.kind, words) +
                         (term.kind == AxisTermKind::reversal_width ? reversal_words(fit.reversal) : "")));
  }
  line(fmt::format("{} over {}", words.load, words.place),
       fmt::format("{:.4g} {} between its lowest and highest, from {:.4g} to {:.4g} {}", fit.place_range,
                   words.load_unit, fit.knots.front(), fit.knots.back(), words.place_unit));
  line("work lost in a cycle", fmt::format("{:.4g} {}{}", fit.loss, words.load_unit,
                                           words.place_unit == "rad" ? " rad" : " " + words.place_unit));
  line(fmt::format("held-out RMS of the {}", words.load),
       fmt::format("{:.4g} {} about its mean, {:.4g} {} after the fit; {} samples, {} reversal{}", fit.before,
                   words.load_unit, fit.after, words.load_unit, fit.samples, fit.reversals,
                   fit.reversals == 1 ? "" : "s"));
  for (std::size_t k = 0; k < fit.steps.size(); ++k) {
    line(fmt::format("  {} {}", k == 0 ? "with the" : "and", fit.steps[k].added),
         fmt::format("{:.4g} {}", fit.steps[k].left, words.load_unit));
  }
  return text;
}

std::string axis_json(const AxisFit& fit, const AxisWords& words, const std::optional<AxisFloor>& floor) {
  nlohmann::ordered_json j{{"schema", "touchstone-axis/1"},
                           {"place", {{"name", words.place}, {"unit", words.place_unit}}},
                           {"load", {{"name", words.load}, {"unit", words.load_unit}}}};
  j["terms"] = nlohmann::ordered_json::array();
  for (const AxisTerm& term : fit.terms) {
    nlohmann::ordered_json one{
        {"name", to_string(term.kind)}, {"value", term.value}, {"unit", unit_of_term(term.kind, words)}};
    if (term.standard_error) one["standard_error"] = *term.standard_error;
    j["terms"].push_back(std::move(one));
  }
  j["over_place"] = {{"place", fit.knots}, {"load", fit.over_place}, {"range", fit.place_range}};
  if (!fit.friction_over_place.empty()) j["over_place"]["friction"] = fit.friction_over_place;
  j["held_out_rms"] = {{"before", fit.before}, {"after", fit.after}};
  j["steps"] = nlohmann::ordered_json::array();
  for (const AxisStep& step : fit.steps) j["steps"].push_back({{"added", step.added}, {"held_out_rms", step.left}});
  j["reversal"] = reversal_name(fit.reversal);
  j["loss_per_cycle"] = fit.loss;
  j["reversals"] = fit.reversals;
  j["speed"] = {{"percentile10", fit.slowest}, {"percentile90", fit.fastest}};
  j["friction_undecided"] = fit.friction_undecided;
  j["alone"] = {{"dry", fit.dry_alone},
                {"dry_left", fit.dry_left},
                {"viscous", fit.viscous_alone},
                {"viscous_left", fit.viscous_left}};
  if (floor) j["repeat_floor"] = floor->value;
  j["remarks"] = axis_remarks(fit, words, floor);
  return j.dump(1) + "\n";
}

}  // namespace touchstone::axis
