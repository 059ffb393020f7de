// "touchstone-perception/2": what perceive writes for programs.
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/perception/judge/judged_conditions.h"

namespace touchstone::perception {
namespace {

using JudgeJson = nlohmann::ordered_json;

JudgeJson finite(double value) { return std::isfinite(value) ? JudgeJson(value) : JudgeJson(); }

JudgeJson hardness_json(const std::optional<RateHardnessEstimate>& estimate) {
  if (!estimate) return {};
  return {{"value", finite(estimate->value_N_per_m)},
          {"interval95", {finite(estimate->low95_N_per_m), finite(estimate->high95_N_per_m)}},
          {"contacts", estimate->contacts}};
}

JudgeJson places_json(const PlaceMap& map) {
  JudgeJson places = JudgeJson::array();
  for (const auto& cell : map.cells) {
    const auto known = [&cell](double value) { return cell.known ? finite(value) : JudgeJson(); };
    places.push_back({{"position_m", {cell.centre_m.x(), cell.centre_m.y(), cell.centre_m.z()}},
                      {"real_N", known(cell.real_N)},
                      {"rendered_N", known(cell.rendered_N)},
                      {"jnd", known(cell.jnd)},
                      {"standard_error_jnd", known(std::hypot(cell.standard_error, cell.by_hand))}});
  }
  return places;
}

JudgeJson condition_json(const JudgedCondition& own) {
  const Judgement& j = own.judgement;
  JudgeJson channels = JudgeJson::array();
  JudgeJson unseen = JudgeJson::array();
  for (const auto& channel : j.channels) {
    if (!channel.known) {
      unseen.push_back({{"name", name_of(channel.channel)}, {"why", channel.why}});
      continue;
    }
    channels.push_back({{"name", name_of(channel.channel)},
                        {"jnd", finite(channel.jnd)},
                        {"probability", finite(channel.probability)},
                        {"standard_error_jnd", finite(channel.standard_error)},
                        {"what", channel.what},
                        {"remedy", channel.remedy},
                        {"depth_m", finite(channel.depth_m)}});
  }
  JudgeJson others = JudgeJson::object();
  for (const auto& other : own.others) {
    JudgeJson entry{{"value", other.value ? finite(*other.value) : JudgeJson()},
                    {"unit", other.unit},
                    {"larger_is_better", other.larger_is_better}};
    if (!other.why.empty()) entry["why"] = other.why;
    others[other.name] = entry;
  }
  JudgeJson where;
  if (!j.moments.empty()) {
    where = {{"t_s", finite(own.strongest_s)},
             {"position_m", {own.strongest_W_m.x(), own.strongest_W_m.y(), own.strongest_W_m.z()}},
             {"noticed_share", finite(j.noticed_share)}};
  }
  return {{"name", own.name},
          {"noticed_probability", finite(j.noticed_probability)},
          {"noticed_interval95", {finite(j.noticed_low95), finite(j.noticed_high95)}},
          {"d_prime", finite(j.d_prime)},
          {"d_prime_interval95", {finite(j.d_prime_low95), finite(j.d_prime_high95)}},
          {"verdict", name_of(j.verdict)},
          {"above_noise", j.above_noise},
          {"gives_away", j.gives_away ? JudgeJson(name_of(*j.gives_away)) : JudgeJson()},
          {"rank", own.rank},
          {"group", own.group},
          {"behind_probability", finite(own.behind_probability)},
          {"channels", channels},
          {"unseen_channels", unseen},
          {"strongest_moment", where},
          {"places", places_json(j.places.force)},
          {"friction_places", places_json(j.places.friction)},
          {"same_motion", j.same_motion},
          {"extended_rate_hardness_N_per_m", hardness_json(own.rate_hardness)},
          {"other_metrics", others},
          {"remarks", j.remarks}};
}

}  // namespace

std::string judged_to_json(const JudgedConditions& judged, const JudgeOptions& options) {
  JudgeJson document{{"schema", "touchstone-perception/2"},
                     {"method", "judge"},
                     {"rate_Hz", finite(judged.rate_Hz)},
                     {"samples", judged.samples},
                     {"outward", {judged.outward.x(), judged.outward.y(), judged.outward.z()}},
                     {"repeats", judged.floor.repeats}};
  JudgeJson floor = JudgeJson::object();
  for (std::size_t c = 0; c < judged.floor.jnd.size(); ++c)
    floor[std::string(name_of(static_cast<Channel>(c)))] = finite(judged.floor.jnd[c]);
  document["noise_floor_jnd"] = judged.floor.repeats > 0 ? floor : JudgeJson();
  document["extended_rate_hardness_N_per_m"] = hardness_json(judged.real_rate_hardness);
  document["conditions"] = JudgeJson::array();
  for (const auto& own : judged.conditions) document["conditions"].push_back(condition_json(own));
  document["thresholds"] = JudgeJson::parse(thresholds_to_json(options.thresholds));
  return document.dump(2) + "\n";
}

}  // namespace touchstone::perception
