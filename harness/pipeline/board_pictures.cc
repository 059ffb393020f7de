#include "harness/pipeline/board_pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "harness/base/markup.h"
#include "harness/report/page_html.h"
#include "harness/report/quantity.h"

namespace touchstone::pipeline {
namespace {

// Sizes in units of the picture, which is as wide as the column that it stands in.
constexpr double width = 640.0;
constexpr double printed_values = 112.0;  // column of the values
constexpr double character = 11.6;        // of a letter at the size that a phone gets (site_assets.h), 19
constexpr std::size_t longest_name = 20;  // letters of a name; longer ones are shortened
constexpr double row = 26.0;
constexpr double top = 30.0;

// Letters of UTF-8 are not cut apart.
std::string short_name(const std::string& name) {
  if (name.size() <= longest_name) return name;
  std::size_t end = longest_name - 1;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xC0U) == 0x80U) --end;
  return name.substr(0, end) + "\u2026";
}

struct Bar {
  std::string name;
  double value, low, high;
};

struct Mark {
  std::string name;
  const char* style;
  double value;
};

// A logarithmic axis between two values.
struct LogAxis {
  double low, high, from, to;
  [[nodiscard]] double at(double value) const {
    return from + (to - from) * std::log(value / low) / std::log(high / low);
  }
};

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, escape_html(text));
}

std::string line_at(double x1, double y1, double x2, double y2, const char* style) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" class=\"{}\"/>\n", x1, y1, x2, y2,
                     style);
}

std::string picture_of(double height, const std::string& label, const std::string& body) {
  return fmt::format(
      "<svg class=\"picture\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {:.0f} {:.0f}\" "
      "xmlns=\"http://www.w3.org/2000/svg\">\n{}</svg>\n",
      escape_html(label), width, height, body);
}

// `groups` of places in `bars`.
std::string bars_picture(const std::string& label, const std::vector<Bar>& bars, const std::vector<Mark>& marks,
                         const std::vector<std::pair<std::size_t, std::size_t>>& groups) {
  double low = bars.front().value;
  double high = low;
  for (const Bar& bar : bars) {
    low = std::min({low, bar.value, bar.low > 0.0 ? bar.low : bar.value});
    high = std::max({high, bar.value, bar.high});
  }
  for (const Mark& mark : marks) {
    low = std::min(low, mark.value);
    high = std::max(high, mark.value);
  }
  if (!(low > 0.0) || !std::isfinite(high)) return "";
  const double room = 9.0 * static_cast<double>(groups.size());
  std::size_t longest = 0;
  for (const Bar& bar : bars) longest = std::max(longest, short_name(bar.name).size());
  const double names = 14.0 + character * static_cast<double>(std::max<std::size_t>(longest, 10));
  const LogAxis axis{low / 1.1, high * 1.1, names, width - printed_values - room};
  const double bottom = top + row * static_cast<double>(bars.size());
  std::string body;
  for (const Mark& mark : marks) {
    const double x = axis.at(mark.value);
    body += line_at(x, top - 6.0, x, bottom, mark.style);
    body += text_at(std::clamp(x, names + 40.0, width - printed_values), top - 12.0, "middle", mark.name);
  }
  for (std::size_t i = 0; i < bars.size(); ++i) {
    const double y = top + row * (static_cast<double>(i) + 0.5);
    body += text_at(names - 10.0, y + 4.0, "end", short_name(bars[i].name));
    body += line_at(axis.from, y, axis.to, y, "grid");
    if (bars[i].low > 0.0 && bars[i].high > bars[i].low)
      body += line_at(axis.at(bars[i].low), y, axis.at(bars[i].high), y, "interval");
    body += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" class=\"dot\"/>\n", axis.at(bars[i].value), y);
    body += text_at(width - 4.0, y + 4.0, "end", report::display_quantity(bars[i].value, "N"));
  }
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const double x = axis.to + 6.0 + 9.0 * static_cast<double>(g);
    body += line_at(x, top + row * static_cast<double>(groups[g].first) + 6.0, x,
                    top + row * static_cast<double>(groups[g].second + 1) - 6.0, "group");
  }
  return picture_of(bottom + 8.0, label, body);
}

std::string ranking_picture(const std::string& label, const Ranking& ranking, const std::vector<Mark>& marks,
                            const std::function<std::string(std::size_t)>& name_of) {
  std::vector<Bar> bars;
  for (const RankedRenderer& one : ranking.order) {
    if (one.log_score > std::log(1e-200))
      bars.push_back({name_of(one.renderer), std::exp(one.log_score), std::exp(one.low95), std::exp(one.high95)});
  }
  if (bars.empty()) return "";
  std::vector<std::pair<std::size_t, std::size_t>> groups;
  const auto row_of = [&](std::size_t place) {
    return static_cast<std::size_t>(std::ranges::find(ranking.order, place, &RankedRenderer::renderer) -
                                    ranking.order.begin());
  };
  if (ranking.why_not.empty() && bars.size() == ranking.order.size()) {
    for (const auto& group : ranking.groups) groups.emplace_back(row_of(group.front()), row_of(group.back()));
  }
  return bars_picture(label, bars, marks, groups);
}

}  // namespace

std::string error_picture(const Task& task) {
  if (!task.ranking) return "";
  std::vector<Mark> marks;
  if (task.floor && task.floor->rms_N > 0.0) marks.push_back({"floor", "floor", task.floor->rms_N});
  if (task.measured_rms_N > 0.0) marks.push_back({"measured force", "measured", task.measured_rms_N});
  return ranking_picture("RMS force error of each renderer on " + task.name, *task.ranking, marks,
                         [&](std::size_t place) { return task.entries[task.ranked[place]].renderer; });
}

std::string error_picture(const Overall& overall) {
  return ranking_picture("RMS force error over all recordings", overall.ranking, {},
                         [&](std::size_t place) { return overall.renderers[place]; });
}

std::string pareto_picture(const Overall& overall) {
  std::vector<std::size_t> shown;
  for (std::size_t i = 0; i < overall.renderers.size(); ++i) {
    const Scores& s = overall.scores[i];
    if (s.mean_operations > 0.0 && s.rms_force_error_N > 0.0) shown.push_back(i);
  }
  if (shown.size() < 2) return "";
  const auto operations = [&](std::size_t i) { return overall.scores[i].mean_operations; };
  const auto error = [&](std::size_t i) { return overall.scores[i].rms_force_error_N; };
  const auto [few, many] = std::ranges::minmax(shown, {}, operations);
  const auto [small, large] = std::ranges::minmax(shown, {}, error);
  constexpr double height = 320.0;
  const LogAxis x{operations(few) / 1.3, operations(many) * 1.3, printed_values, width - 90.0};
  const LogAxis y{error(small) / 1.15, error(large) * 1.15, height - 50.0, 20.0};
  std::string body = line_at(x.from, y.from, x.to, y.from, "axis") + line_at(x.from, y.from, x.from, y.to, "axis");
  body += text_at(0.5 * (x.from + x.to), height - 8.0, "middle", "operations of a step");
  body += text_at(x.from, 12.0, "start", "RMS force error");
  for (const std::size_t i : {few, many})
    body += text_at(x.at(operations(i)), y.from + 18.0, "middle", fmt::format("{:.0f}", operations(i)));
  for (const std::size_t i : {small, large})
    body += text_at(x.from - 6.0, y.at(error(i)) + 4.0, "end", report::display_quantity(error(i), "N"));
  std::vector<std::size_t> front = shown;
  std::erase_if(front, [&](std::size_t i) { return !overall.pareto[i]; });
  std::ranges::sort(front, {}, operations);
  std::string path;
  for (const std::size_t i : front)
    path += fmt::format("{}{:.1f},{:.1f}", path.empty() ? "" : " ", x.at(operations(i)), y.at(error(i)));
  body += fmt::format("<polyline points=\"{}\" class=\"front\"/>\n", path);
  for (const std::size_t i : shown) {
    body += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"5\" class=\"{}\"/>\n", x.at(operations(i)),
                        y.at(error(i)), overall.pareto[i] ? "dot" : "beaten");
  }
  // Names of renderers that lie close together are set below one another.
  std::ranges::sort(shown, {}, [&](std::size_t i) { return y.at(error(i)); });
  double last_y = -100.0;
  for (const std::size_t i : shown) {
    const double place = std::max(y.at(error(i)) + 4.0, last_y + 18.0);
    last_y = place;
    const bool right = x.at(operations(i)) < 0.5 * (x.from + x.to);
    body += text_at(x.at(operations(i)) + (right ? 9.0 : -9.0), place, right ? "start" : "end",
                    short_name(overall.renderers[i]));
  }
  return picture_of(height, "RMS force error against operations of a step", body);
}

}  // namespace touchstone::pipeline
