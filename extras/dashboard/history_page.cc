#include "history_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "harness/base/markup.h"

namespace touchstone::dashboard {
namespace {

// Places of values and builds on a drawing of fixed size.
class Axes {
 public:
  static constexpr double width = 900.0;
  static constexpr double height = 240.0;

  explicit Axes(const HistorySeries& series) : count_(series.points.size()) {
    low_ = high_ = series.points.empty() ? 0.0 : series.points.front().value;
    for (const auto& point : series.points) {
      low_ = std::min(low_, point.value);
      high_ = std::max(high_, point.value);
    }
    if (low_ == high_) {
      const double around = std::max(std::abs(low_), 1.0) * 0.5;
      low_ -= around;
      high_ += around;
    }
  }
  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }
  [[nodiscard]] double x(double index) const {
    return left + (index + 0.5) * (width - left - right) / static_cast<double>(std::max<std::size_t>(count_, 1));
  }
  [[nodiscard]] double y(double value) const {
    return height - bottom - (value - low_) / (high_ - low_) * (height - top - bottom);
  }

 private:
  static constexpr double left = 90.0;
  static constexpr double right = 10.0;
  static constexpr double top = 14.0;
  static constexpr double bottom = 14.0;
  std::size_t count_;
  double low_ = 0.0;
  double high_ = 0.0;
};

std::string drawing(const JudgedSeries& judged) {
  const Axes axes(judged.series);
  std::string svg = fmt::format("<svg viewBox=\"0 0 {} {}\" role=\"img\">", Axes::width, Axes::height);
  for (const double value : {axes.low(), axes.high()}) {
    svg += fmt::format(
        "<line class=\"grid\" x1=\"90\" x2=\"{0}\" y1=\"{1:.2f}\" y2=\"{1:.2f}\"/><text x=\"84\" "
        "y=\"{2:.2f}\">{3:.6g}</text>",
        Axes::width, axes.y(value), axes.y(value) + 4.0, value);
  }
  for (const auto& finding : judged.verdict.findings) {
    if (!finding.change) continue;
    const auto& change = judged.verdict.report.changes[*finding.change];
    const double from = axes.x(static_cast<double>(change.first) - 0.5);
    svg += fmt::format("<rect class=\"{}\" x=\"{:.2f}\" y=\"0\" width=\"{:.2f}\" height=\"{}\"/>",
                       finding.fails ? "bad" : "known", from, axes.x(static_cast<double>(change.last) + 0.5) - from,
                       Axes::height);
  }
  for (const auto& level : judged.verdict.report.levels) {
    svg += fmt::format("<line class=\"level\" x1=\"{:.2f}\" x2=\"{:.2f}\" y1=\"{:.2f}\" y2=\"{:.2f}\"/>",
                       axes.x(static_cast<double>(level.first) - 0.5), axes.x(static_cast<double>(level.end) - 0.5),
                       axes.y(level.from), axes.y(level.to));
  }
  for (std::size_t i = 0; i < judged.series.points.size(); ++i) {
    const auto& point = judged.series.points[i];
    svg += fmt::format("<circle cx=\"{:.2f}\" cy=\"{:.2f}\" r=\"2.5\"><title>{} {} {:.8g}</title></circle>",
                       axes.x(static_cast<double>(i)), axes.y(point.value), escape_html(point.commit),
                       escape_html(point.time), point.value);
  }
  return svg + "</svg>";
}

constexpr const char* style =
    "body{font:15px sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem}svg{width:100%;background:#fafafa}"
    "circle{fill:#1f5f99}.level{stroke:#d95f02;stroke-width:2}.grid{stroke:#ddd}text{font:11px "
    "sans-serif;text-anchor:end}"
    ".bad{fill:#c0392b;opacity:.25}.known{fill:#888;opacity:.2}.failed{color:#c0392b;font-weight:bold}h2{font-size:"
    "1rem}";

}  // namespace

report::Plot history_plot(const JudgedSeries& judged) {
  report::PlotPanel panel{judged.series.key.metric, judged.series.key.metric, {{"measured", {}, true}}, {0.0, 0.0}};
  for (std::size_t i = 0; i < judged.series.points.size(); ++i)
    panel.lines[0].points.emplace_back(static_cast<double>(i + 1), judged.series.points[i].value);
  for (const auto& level : judged.verdict.report.levels) {
    panel.lines.push_back(
        {panel.lines.size() == 1 ? "level" : "",
         {{static_cast<double>(level.first) + 0.5, level.from}, {static_cast<double>(level.end) + 0.5, level.to}},
         false});
  }
  return {title_of(judged.series.key), "build, oldest first", {panel}};
}

nlohmann::json history_json(const std::vector<JudgedSeries>& all) {
  nlohmann::json series = nlohmann::json::array();
  bool any = false;
  for (const JudgedSeries& judged : all) {
    const auto& [key, points] = judged.series;
    nlohmann::json values = nlohmann::json::array();
    for (const auto& point : points)
      values.push_back({{"commit", point.commit}, {"time", point.time}, {"value", point.value}});
    nlohmann::json changes = nlohmann::json::array();
    for (const auto& change : judged.verdict.report.changes) {
      changes.push_back({{"kind", change.kind == change_points::ChangeKind::step ? "step" : "drift"},
                         {"index", change.index},
                         {"first", change.first},
                         {"last", change.last},
                         {"before", change.before},
                         {"after", change.after},
                         {"p", change.p}});
    }
    nlohmann::json findings = nlohmann::json::array();
    for (const auto& finding : judged.verdict.findings)
      findings.push_back({{"sentence", finding.sentence}, {"fails", finding.fails}});
    any = any || judged.verdict.failed();
    series.push_back({{"site", key.site},
                      {"build", key.build},
                      {"track", key.track},
                      {"test", key.test},
                      {"metric", key.metric},
                      {"exact", judged.verdict.report.exact},
                      {"values", values},
                      {"changes", changes},
                      {"findings", findings},
                      {"failed", judged.verdict.failed()}});
  }
  return {{"schema", "touchstone-history-verdict/1"}, {"failed", any}, {"series", series}};
}

std::string history_page(const std::vector<JudgedSeries>& all, const std::string& title) {
  std::vector<const JudgedSeries*> order;
  for (const auto& judged : all) order.push_back(&judged);
  std::ranges::stable_sort(order, std::ranges::greater{}, [](const JudgedSeries* j) { return j->verdict.failed(); });
  const auto failed = std::ranges::count_if(all, [](const JudgedSeries& j) { return j.verdict.failed(); });
  std::string page = fmt::format(
      "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>{0}</title><style>{1}</style></head><body>"
      "<h1>{0}</h1><p>{2} series, {3} failed.</p>",
      escape_html(title), style, all.size(), failed);
  const auto quiet = [](const JudgedSeries* judged) { return judged->verdict.findings.empty(); };
  std::ranges::stable_partition(order, std::not_fn(quiet));
  const auto quiet_begin = std::ranges::find_if(order, quiet);
  for (auto at = order.begin(); at != order.end(); ++at) {
    const JudgedSeries* const judged = *at;
    if (at == quiet_begin)
      page += fmt::format("<details{}><summary>Series without a finding: {}</summary>", failed == 0 ? " open" : "",
                          std::distance(quiet_begin, order.end()));
    page += fmt::format("<h2>{}</h2>{}<ul>", escape_html(title_of(judged->series.key)), drawing(*judged));
    for (const auto& finding : judged->verdict.findings)
      page += fmt::format("<li{}>{}</li>", finding.fails ? " class=\"failed\"" : "", escape_html(finding.sentence));
    page += "</ul>";
  }
  if (quiet_begin != order.end()) page += "</details>";
  return page + "</body></html>\n";
}

}  // namespace touchstone::dashboard
