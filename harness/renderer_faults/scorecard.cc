#include "harness/renderer_faults/scorecard.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "harness/base/markup.h"
#include "harness/renderer_faults/probe.h"
#include "harness/surface/sphere_mesh.h"

namespace touchstone::renderer_faults {
namespace {

std::size_t count_of(const Scorecard& card, bool CaseScore::*verdict) {
  return static_cast<std::size_t>(
      std::ranges::count_if(card.cases, [&](const CaseScore& one) { return one.problem.empty() && one.*verdict; }));
}

std::size_t skipped_of(const Scorecard& card) {
  return static_cast<std::size_t>(std::ranges::count_if(card.cases, &CaseScore::skipped));
}

bool is_allowed(const Scorecard& card, const std::string& name) {
  return std::ranges::find(card.allowed, name) != card.allowed.end();
}

// Its cause is allowed, and with it what follows.
bool is_allowed(const Scorecard& card, const Finding& finding) {
  return is_allowed(card, finding.name) || is_allowed(card, finding.follows_from);
}

// Allowed and not found: the line that allows it can go.
std::vector<std::string> allowed_in_vain(const Scorecard& card) {
  std::vector<std::string> names;
  for (const std::string& name : card.allowed) {
    const Diagnosis& d = card.diagnosis;
    const bool found = std::ranges::find(d.findings, name, &Finding::name) != d.findings.end() ||
                       std::ranges::any_of(d.failed, [&](const auto& one) { return one.first == name; }) ||
                       std::ranges::any_of(card.cases, [&](const auto& one) { return one.name == name && fails(one); });
    if (!found) names.push_back(name);
  }
  return names;
}

std::string cases_sentence(const Scorecard& card) {
  if (!card.cases_wanted) return "not run";
  const std::size_t skipped = skipped_of(card);
  return fmt::format("{} of {} exact, {} felt (within {:g} JND){}", count_of(card, &CaseScore::exact),
                     card.cases.size() - skipped, count_of(card, &CaseScore::felt), card.felt_tolerance_jnd,
                     skipped > 0 ? fmt::format(", {} skipped", skipped) : "");
}

// Detectors stand in the order in which faults are worth fixing.
std::string first_to_fix(const Scorecard& card) {
  for (const Finding& finding : card.diagnosis.findings) {
    if (!is_allowed(card, finding)) return finding.name;
  }
  const CaseScore* worst = nullptr;
  for (const CaseScore& one : card.cases) {
    if (!fails(one) || is_allowed(card, one.name)) continue;
    if (worst == nullptr || one.max_jnd > worst->max_jnd) worst = &one;
  }
  return worst == nullptr ? "" : "case " + worst->name;
}

std::string considered_sentence(const Finding& finding) {
  std::string text;
  for (const auto& [name, why] : finding.considered)
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", name, why);
  return text;
}

nlohmann::ordered_json pairs_to_json(const std::vector<std::pair<std::string, std::string>>& pairs) {
  auto out = nlohmann::ordered_json::array();
  for (const auto& [name, reason] : pairs) out.push_back({{"name", name}, {"reason", reason}});
  return out;
}

// What an engine says on a diagnosis: found, clean, declared or not looked for.
std::string cell_of(const Scorecard& card, const std::string& detector) {
  const Diagnosis& d = card.diagnosis;
  const auto named = [&](const auto& pair) { return pair.first == detector; };
  if (const auto found = std::ranges::find(d.findings, detector, &Finding::name); found != d.findings.end()) {
    return fmt::format(
        "<td class=\"bad\"><b>{}</b><br>{}<br><small>{}{}</small></td>",
        found->follows_from.empty() ? "found" : "follows from " + found->follows_from, escape_html(found->what),
        escape_html(found->smallest_case),
        found->considered.empty() ? "" : "; considered too: " + escape_html(considered_sentence(*found)));
  }
  if (const auto said = std::ranges::find(d.said, detector, &Finding::name); said != d.said.end())
    return "<td>" + escape_html(said->what) + "</td>";
  if (std::ranges::find(d.clean, detector) != d.clean.end()) return "<td class=\"good\">clean</td>";
  if (const auto at = std::ranges::find_if(d.declared, named); at != d.declared.end())
    return fmt::format("<td>declared: {}</td>", escape_html(at->second));
  if (const auto at = std::ranges::find_if(d.failed, named); at != d.failed.end())
    return fmt::format("<td class=\"bad\">could not run: {}</td>", escape_html(at->second));
  return "<td>not looked for</td>";
}

std::string case_cell(const Scorecard& card, const std::string& name) {
  const auto found = std::ranges::find(card.cases, name, &CaseScore::name);
  if (found == card.cases.end()) return "<td></td>";
  if (found->skipped) return fmt::format("<td>skipped: {}</td>", escape_html(found->problem));
  if (!found->problem.empty()) return fmt::format("<td class=\"bad\">{}</td>", escape_html(found->problem));
  return fmt::format("<td class=\"{}\">{:.3g} N rms, {:.3g} N at most, {:.3g} JND ({}){}</td>",
                     found->felt ? "good" : "bad", found->rms_N, found->max_N, found->max_jnd, found->reference,
                     found->exact ? ", exact" : "");
}

}  // namespace

bool fails(const CaseScore& one) { return !one.skipped && (!one.problem.empty() || !one.felt); }

CardVerdict verdict_of(const Scorecard& card) {
  const auto counts = [&](const std::string& name) { return !is_allowed(card, name); };
  const Diagnosis& d = card.diagnosis;
  if (std::ranges::any_of(d.findings, [&](const Finding& one) { return !is_allowed(card, one); }) ||
      std::ranges::any_of(d.failed, [&](const auto& pair) { return counts(pair.first); }) ||
      std::ranges::any_of(card.cases, [&](const CaseScore& one) { return fails(one) && counts(one.name); }))
    return CardVerdict::failed;
  if (card.cases_wanted && skipped_of(card) == card.cases.size()) return CardVerdict::skipped;
  return CardVerdict::passed;
}

std::string_view to_string(CardVerdict verdict) {
  switch (verdict) {
    case CardVerdict::passed:
      return "passed";
    case CardVerdict::skipped:
      return "skipped";
    case CardVerdict::failed:
      break;
  }
  return "failed";
}

CostScore measure_cost(const Engine& engine, int levels) {
  using Clock = std::chrono::steady_clock;
  const auto us = [](Clock::duration d) { return std::chrono::duration<double, std::micro>(d).count(); };
  const surface::TriangleMesh ball = surface::sphere_mesh(half_side_m, levels);
  CostScore cost;
  cost.triangles = ball.triangle_count();
  const auto began = Clock::now();
  Probe probe(engine, ball);
  cost.build_ms = 1e-3 * us(Clock::now() - began);
  probe.approach({0.0, 0.0, half_side_m}, Vec3::UnitZ(), probe_depth_m);
  constexpr int steps = 20'000;
  constexpr double longest_us = 1e7;
  std::vector<double> each_us;
  each_us.reserve(steps);
  double all_us = 0.0;
  for (int i = 0; i < steps && all_us < longest_us; ++i) {
    // A great circle that leans over, in and out of contact: 40 rounds at 0.25 mm a step.
    const double angle = 0.0125 * i;
    const Vec3 out(std::sin(angle), 0.3 * std::sin(0.37 * angle), std::cos(angle));
    const Vec3 tip = (half_side_m + engine.tip_radius_m - probe_depth_m * std::sin(0.05 * i)) * out.normalized();
    const auto before = Clock::now();
    probe.to(tip);
    each_us.push_back(us(Clock::now() - before));
    all_us += each_us.back();
  }
  std::ranges::sort(each_us);
  const auto quantile = [&](double q) {
    return each_us[std::min(each_us.size() - 1, static_cast<std::size_t>(q * static_cast<double>(each_us.size())))];
  };
  cost.steps = each_us.size();
  cost.median_us = quantile(0.5);
  cost.p99_us = quantile(0.99);
  cost.p999_us = quantile(0.999);
  return cost;
}

std::string scorecard_to_json(const Scorecard& card) {
  nlohmann::ordered_json out;
  out["schema"] = "touchstone-scorecard/1";
  out["engine"] = {{"name", card.engine},         {"summary", card.summary},          {"source", card.source},
                   {"library", card.library},     {"sha256", card.library_sha256},    {"options", card.options},
                   {"epsilon_m", card.epsilon_m}, {"world_unit_m", card.world_unit_m}};
  out["verdict"] = to_string(verdict_of(card));
  out["allowed"] = card.allowed;
  out["fix_first"] = first_to_fix(card);
  out["findings"] = nlohmann::ordered_json::array();
  for (const Finding& finding : card.diagnosis.findings) {
    out["findings"].push_back({{"name", finding.name},
                               {"what", finding.what},
                               {"smallest_case", finding.smallest_case},
                               {"value", finding.value},
                               {"unit", finding.unit},
                               {"follows_from", finding.follows_from},
                               {"considered", pairs_to_json(finding.considered)}});
  }
  out["said"] = nlohmann::ordered_json::array();
  for (const Finding& one : card.diagnosis.said) out["said"].push_back({{"name", one.name}, {"what", one.what}});
  out["clean"] = card.diagnosis.clean;
  out["declared"] = pairs_to_json(card.diagnosis.declared);
  out["could_not_run"] = pairs_to_json(card.diagnosis.failed);
  out["felt_tolerance_jnd"] = card.felt_tolerance_jnd;
  out["cases"] = nlohmann::ordered_json::array();
  for (const CaseScore& one : card.cases) {
    if (!one.problem.empty()) {
      out["cases"].push_back({{"name", one.name}, {"problem", one.problem}, {"skipped", one.skipped}});
      continue;
    }
    out["cases"].push_back({{"name", one.name},
                            {"shape", one.shape},
                            {"reference", one.reference},
                            {"samples", one.samples},
                            {"force_mean_N", one.mean_N},
                            {"force_rms_N", one.rms_N},
                            {"force_max_N", one.max_N},
                            {"force_jump_N", one.jump_N},
                            {"right_max_N", one.right_N},
                            {"force_max_jnd", one.max_jnd},
                            {"exact", one.exact},
                            {"felt", one.felt}});
  }
  out["passed"] = {{"cases", card.cases.size()},
                   {"skipped", skipped_of(card)},
                   {"exact", count_of(card, &CaseScore::exact)},
                   {"felt", count_of(card, &CaseScore::felt)}};
  out["cost"] = nullptr;
  if (card.cost) {
    out["cost"] = {{"triangles", card.cost->triangles}, {"steps", card.cost->steps},
                   {"median_us", card.cost->median_us}, {"p99_us", card.cost->p99_us},
                   {"p999_us", card.cost->p999_us},     {"build_ms", card.cost->build_ms}};
  }
  return out.dump(1) + "\n";
}

std::string scorecard_to_html(const std::vector<Scorecard>& cards) {
  std::string page =
      "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Scorecard</title><style>"
      "body{font-family:sans-serif;margin:2em}table{border-collapse:collapse}td,th{border:1px solid #bbb;padding:.4em;"
      "text-align:left;vertical-align:top;max-width:26em}.good{background:#e6f4e6}.bad{background:#fbe3e0}"
      "</style></head><body><h1>Scorecard</h1>\n";
  const auto row = [&](const std::string& head, const auto& cell) {
    page += "<tr><th>" + head + "</th>";
    for (const Scorecard& card : cards) page += cell(card);
    page += "</tr>\n";
  };
  const auto plain = [](const std::string& text) { return "<td>" + escape_html(text) + "</td>"; };
  page += "<table>\n";
  row("engine", [](const Scorecard& card) { return "<th>" + escape_html(card.engine) + "</th>"; });
  row("what it is", [&](const Scorecard& card) { return plain(card.summary + "; " + card.source); });
  row("library", [&](const Scorecard& card) {
    return plain(card.library.empty() ? "of this program" : card.library + ", SHA-256 " + card.library_sha256);
  });
  row("options", [&](const Scorecard& card) { return plain(card.options); });
  row("verdict", [&](const Scorecard& card) { return plain(std::string(to_string(verdict_of(card)))); });
  row("fix first", [&](const Scorecard& card) {
    const std::string first = first_to_fix(card);
    return plain(first.empty() ? "nothing was found" : first);
  });
  row("golden cases", [&](const Scorecard& card) { return plain(cases_sentence(card)); });
  row("cost of a step", [&](const Scorecard& card) {
    if (!card.cost) return plain("not measured");
    return plain(fmt::format("median {:.3g} us, p99 {:.3g} us, p99.9 {:.3g} us; made in {:.3g} ms; {} triangles",
                             card.cost->median_us, card.cost->p99_us, card.cost->p999_us, card.cost->build_ms,
                             card.cost->triangles));
  });
  page += "</table>\n<h2>Diagnoses</h2>\n<table>\n";
  row("", [](const Scorecard& card) { return "<th>" + escape_html(card.engine) + "</th>"; });
  for (const Detector& detector : detectors()) {
    row(fmt::format("{}<br><small>{}</small>", escape_html(detector.name), escape_html(detector.summary)),
        [&](const Scorecard& card) { return cell_of(card, detector.name); });
  }
  page += "</table>\n<h2>Golden cases</h2>\n<table>\n";
  row("", [](const Scorecard& card) { return "<th>" + escape_html(card.engine) + "</th>"; });
  std::vector<std::string> names;
  for (const Scorecard& card : cards) {
    for (const CaseScore& one : card.cases) {
      if (std::ranges::find(names, one.name) == names.end()) names.push_back(one.name);
    }
  }
  for (const std::string& name : names)
    row(escape_html(name), [&](const Scorecard& card) { return case_cell(card, name); });
  page += "</table></body></html>\n";
  return page;
}

std::string scorecard_to_text(const Scorecard& card) {
  const auto causes = std::ranges::count_if(card.diagnosis.findings, &std::string::empty, &Finding::follows_from);
  std::string text = fmt::format("{}: {} fault{} found, {} clean, {} declared\n", card.engine, causes,
                                 causes == 1 ? "" : "s", card.diagnosis.clean.size(), card.diagnosis.declared.size());
  const auto line = [](const Finding& one) { return fmt::format("{}: {}\n", one.name, one.what); };
  for (const Finding& finding : card.diagnosis.findings) {
    if (!finding.follows_from.empty()) continue;
    text += "  " + line(finding);
    if (!finding.considered.empty()) text += fmt::format("    considered too: {}\n", considered_sentence(finding));
    for (const Finding& other : card.diagnosis.findings) {
      if (other.follows_from == finding.name) text += "    follows from it: " + line(other);
    }
  }
  for (const Finding& one : card.diagnosis.said) text += "  said, " + line(one);
  for (const auto& [name, why] : card.diagnosis.failed) text += fmt::format("  {}: could not run: {}\n", name, why);
  text += fmt::format("  golden cases: {}\n", cases_sentence(card));
  if (card.cost) {
    text += fmt::format("  step: median {:.3g} us, p99 {:.3g} us, p99.9 {:.3g} us over {} triangles\n",
                        card.cost->median_us, card.cost->p99_us, card.cost->p999_us, card.cost->triangles);
  }
  if (const std::string first = first_to_fix(card); !first.empty()) text += "  fix first: " + first + "\n";
  if (!card.allowed.empty()) text += fmt::format("  allowed: {}\n", fmt::join(card.allowed, ", "));
  for (const std::string& name : allowed_in_vain(card)) text += "  allowed and not found: " + name + "\n";
  if (verdict_of(card) == CardVerdict::skipped) text += "  no golden case ran: nothing is known of its forces\n";
  text += fmt::format("  verdict: {}\n", to_string(verdict_of(card)));
  return text;
}

}  // namespace touchstone::renderer_faults
