#include "harness/bisection/answer_report.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace touchstone::bisection {
namespace {

std::string brief(const std::string& commit) { return commit.substr(0, 10); }

std::string percent(double share) { return fmt::format("{:+.1f} %", 100.0 * share); }

std::string how_sure(const NamedStep& named) {
  if (!named.step.single())
    return fmt::format("one of {} commits, those between do not build or run", named.commits.size());
  if (named.step.sure())
    return named.step.error > 0.0 ? fmt::format("confidence: high, {:.4g} %", 100.0 * named.step.confidence)
                                  : "confidence: high, measured without noise on both sides";
  return fmt::format("confidence: limited, {:.3g} %", 100.0 * named.step.confidence);
}

std::string text_of(const NamedStep& named) {
  std::string text =
      fmt::format("culprit: {} {}\n  {} of the change ({:+.6g}{}); {}\n", named.commits.back(), named.title,
                  percent(named.step.share), named.step.excess,
                  named.step.error > 0.0 ? fmt::format(" +- {:.2g}", named.step.error) : "", how_sure(named));
  if (!named.merge.empty()) text += fmt::format("  came with the merge {}\n", brief(named.merge));
  if (named.by_merging) text += "  a merge: what it brought does not make this change, putting it together does\n";
  if (!named.step.single()) {
    for (const std::string& commit : named.commits) text += fmt::format("    {}\n", commit);
  }
  return text;
}

}  // namespace

std::string answer_to_text(const BisectionAnswer& answer) {
  const SearchFindings& found = answer.findings;
  const auto& commits = answer.line.commits;
  std::string text = fmt::format("{}: {:.6g} at {} (good), {:.6g} at {} (bad)", answer.metric, found.good,
                                 brief(commits.front()), found.bad, brief(commits.back()));
  if (found.noise > 0.0) text += fmt::format("; noise of one run {:.2g}", found.noise);
  text += fmt::format("; {} commits\n", commits.size() - 1);
  if (!found.ends_differ) {
    text += fmt::format("the ends do not differ by more than {}; nothing was searched\n",
                        found.noise > 0.0 ? fmt::format("noise (standard error {:.2g})", found.end_error) : "rounding");
  }
  for (const NamedStep& named : answer.steps) text += text_of(named);
  for (const NamedDrift& named : answer.drifts) {
    text += fmt::format(
        "drift: {} of the change ({:+.6g}) is spread over {} commits, {} to {}; no group of neighbours that was "
        "measured "
        "holds more than {:.3g}\n",
        percent(named.drift.share), named.drift.change, named.drift.last - named.drift.first, brief(named.first),
        brief(named.last), named.drift.largest);
  }
  if (found.ends_differ && std::abs(found.unexplained_share) > 0.005) {
    text += fmt::format("not located: {} of the change, in changes below {:.3g} each\n",
                        percent(found.unexplained_share), found.matters);
  }
  return text + fmt::format("builds: {}, of them skipped: {}\n", answer.builds, answer.broken);
}

std::string answer_to_json(const BisectionAnswer& answer) {
  using Json = nlohmann::ordered_json;
  const SearchFindings& found = answer.findings;
  Json json{{"schema", "touchstone-bisection-answer/1"},
            {"metric", answer.metric},
            {"good", {{"commit", answer.line.commits.front()}, {"value", found.good}}},
            {"bad", {{"commit", answer.line.commits.back()}, {"value", found.bad}}},
            {"noise", found.noise},
            {"ends_differ", found.ends_differ},
            {"smallest_change_searched", found.matters},
            {"culprits", Json::array()},
            {"drifts", Json::array()},
            {"not_located_share", found.ends_differ ? Json(found.unexplained_share) : Json()},
            {"builds", answer.builds},
            {"broken", answer.broken},
            {"measured", Json::array()}};
  for (const NamedStep& named : answer.steps) {
    Json one{{"commit", named.step.single() ? Json(named.commits.back()) : Json()},
             {"candidates", named.commits},
             {"title", named.title},
             {"change", named.step.excess},
             {"standard_error", named.step.error},
             {"share", named.step.share},
             {"confidence", named.step.confidence},
             {"sure", named.step.sure()}};
    if (!named.merge.empty()) one["merge"] = named.merge;
    one["by_merging"] = named.by_merging;
    json["culprits"].push_back(std::move(one));
  }
  for (const NamedDrift& named : answer.drifts) {
    json["drifts"].push_back({{"first", named.first},
                              {"last", named.last},
                              {"commits", named.drift.last - named.drift.first},
                              {"change", named.drift.change},
                              {"share", named.drift.share}});
  }
  for (const std::size_t i : answer.line.curve.measured_positions()) {
    json["measured"].push_back({{"commit", answer.line.commits[i]},
                                {"value", answer.line.curve.level(i)},
                                {"runs", answer.line.curve.runs(i)}});
  }
  return json.dump(1) + "\n";
}

report::Plot answer_to_plot(const BisectionAnswer& answer) {
  report::PlotPanel panel{answer.metric, answer.metric, {}, {}};
  report::PlotLine measured{"measured", {}, true};
  for (const std::size_t i : answer.line.curve.measured_positions())
    measured.points.emplace_back(static_cast<double>(i), answer.line.curve.level(i));
  panel.lines.push_back(std::move(measured));
  for (const Step& step : answer.findings.steps) {
    const auto before = static_cast<double>(step.before);
    const auto at = static_cast<double>(step.at);
    panel.lines.push_back({answer.line.commits[step.at].substr(0, 10),
                           {{before, answer.line.curve.level(step.before)}, {at, answer.line.curve.level(step.at)}},
                           false});
  }
  return {fmt::format("{} from {} to {}", answer.metric, brief(answer.line.commits.front()),
                      brief(answer.line.commits.back())),
          "commit, oldest first",
          {panel}};
}

}  // namespace touchstone::bisection
