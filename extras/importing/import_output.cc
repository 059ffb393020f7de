// What was imported: as CSV, as a table for people, as a picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "harness/base/atomic_file.h"
#include "harness/base/bar_line.h"
#include "harness/base/error.h"
#include "harness/recording/recording_stream.h"
#include "harness/stats/quantile.h"
#include "import_file.h"

namespace touchstone::importing {
namespace {

bool is_recording(const Imported& imported) {
  const auto has = [&](std::string_view prefix) {
    return std::ranges::any_of(imported.names, [&](const std::string& n) { return n.starts_with(prefix); });
  };
  return has("t_s") && has("x_") && has("fx_");
}

// At most as many values as a line of bars has: each the mean of those that it stands for.
std::vector<double> thinned(const std::vector<double>& values) {
  constexpr std::size_t most = 16;
  const std::size_t bars = std::min(most, values.size());
  std::vector<double> out(bars, 0.0);
  for (std::size_t b = 0; b < bars; ++b) {
    const std::size_t from = b * values.size() / bars, to = (b + 1) * values.size() / bars;
    for (std::size_t i = from; i < to; ++i) out[b] += values[i] / static_cast<double>(to - from);
  }
  return out;
}

// Its end, where names differ, if it is too long for the table.
std::string shown_name(const std::string& name) {
  constexpr std::size_t widest = 17;
  std::size_t at = name.size();
  for (std::size_t room = 0; at > 0 && room + 1 < widest; --at) {
    if ((static_cast<unsigned char>(name[at - 1]) & 0xc0U) != 0x80U) ++room;  // else a byte that continues a character
  }
  return name.size() <= widest || at == 0 ? name : "\xe2\x80\xa6" + name.substr(at);
}

}  // namespace

std::string imported_text(const Imported& imported, const std::map<std::string, std::string>& from) {
  const auto where = [&](const std::string& column) {
    const auto found = from.find(column);
    return found == from.end() ? std::string() : found->second;
  };
  std::string text = fmt::format("{}; {} samples", imported.format, imported.columns.front().size());
  const bool timed = imported.names.front() == "t_s" && imported.columns.front().size() > 1;
  if (timed) {
    const auto& t = imported.columns.front();
    std::vector<double> intervals;
    for (std::size_t i = 1; i < t.size(); ++i) intervals.push_back(t[i] - t[i - 1]);
    const double shortest = *std::ranges::min_element(intervals), longest = *std::ranges::max_element(intervals),
                 usual = stats::upper_median(intervals);
    text += fmt::format("\n{:.6g} s{}, intervals {:.4g} s to {:.4g} s{}", t.back() - t.front(),
                        usual > 0.0 ? fmt::format(" at {:.6g} Hz", 1.0 / usual) : "", shortest, longest,
                        where("t_s").empty() ? "" : fmt::format("; t_s <- {}", where("t_s")));
  }
  text += fmt::format("\n{:9} {:<17} {:>10} {:>10} {:>10}  over the samples\n", "", from.empty() ? "" : "from", "first",
                      "lowest", "highest");
  for (std::size_t c = timed ? 1 : 0; c < imported.names.size(); ++c) {
    const auto& values = imported.columns[c];
    const auto [low, high] = std::ranges::minmax(values);
    text += fmt::format("{:9} {:<17} {:>10.4g} {:>10.4g} {:>10.4g}  {}\n", imported.names[c],
                        shown_name(where(imported.names[c])), values.front(), low, high,
                        bar_line(thinned(values), low, high));
  }
  return text;
}

std::string imported_picture(const Imported& imported, const std::string& title) {
  constexpr int width = 900, height = 90, left = 150, gap = 14, top = 34;
  constexpr std::size_t most_points = 1500;
  const bool timed = imported.names.front() == "t_s" && imported.columns.front().size() > 1;
  const std::size_t n = imported.columns.front().size();
  const std::size_t first = timed ? 1 : 0;
  const int panels = static_cast<int>(imported.names.size() - first);
  std::string safe;
  for (const char c : title) safe += c == '<' || c == '&' || c == '>' ? ' ' : c;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" font-family=\"sans-serif\" "
      "font-size=\"12\">\n<text x=\"10\" y=\"20\">{}</text>\n",
      left + width + 20, top + panels * (height + gap) + 10, safe);
  const double t0 = timed ? imported.columns[0].front() : 0.0;
  const double t1 = timed ? imported.columns[0].back() : static_cast<double>(n);
  for (int p = 0; p < panels; ++p) {
    const auto c = first + static_cast<std::size_t>(p);
    const auto& values = imported.columns[c];
    const auto [low, high] = std::ranges::minmax(values);
    const double span = high > low ? high - low : 1.0;
    const int y0 = top + p * (height + gap);
    svg += fmt::format(
        "<text x=\"10\" y=\"{}\">{}</text><text x=\"10\" y=\"{}\" fill=\"#666\">{:.4g} .. {:.4g}</text>\n"
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"#ccc\"/>\n<polyline fill=\"none\" "
        "stroke=\"#146\" points=\"",
        y0 + 40, imported.names[c], y0 + 56, low, high, left, y0, width, height);
    const std::size_t stride = n / most_points + 1;
    for (std::size_t i = 0; i < n; i += stride) {
      const double t = timed ? imported.columns[0][i] : static_cast<double>(i);
      svg += fmt::format("{:.1f},{:.1f} ", left + width * (t - t0) / (t1 > t0 ? t1 - t0 : 1.0),
                         y0 + height * (1.0 - (values[i] - low) / span));
    }
    svg += "\"/>\n";
  }
  return svg + "</svg>\n";
}

void save_imported(const std::filesystem::path& path, const Imported& imported) {
  if (!path.string().ends_with(".csv")) {
    throw UsageError(fmt::format("--out {}: import writes CSV; name it .csv (`touchstone convert` makes other formats)",
                                 path.string()));
  }
  std::string text;
  for (std::size_t c = 0; c < imported.names.size(); ++c) text += (c > 0 ? "," : "") + imported.names[c];
  text += '\n';
  const std::size_t rows = imported.columns.front().size();
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t c = 0; c < imported.names.size(); ++c) {
      if (c > 0) text += ',';
      fmt::format_to(std::back_inserter(text), "{}", imported.columns[c][i]);
    }
    text += '\n';
  }
  // Beside its place first: a recording that no command would read does not take it.
  if (is_recording(imported)) {
    const std::filesystem::path trial = path.string() + ".import.csv";
    write_file(trial, text);
    try {
      recording::RecordingStream stream = recording::RecordingStream::open(trial, {.need_force = true});
      recording::SampleBlock block;
      while (stream.next(block)) {
      }
    } catch (const BadData& error) {
      std::filesystem::remove(trial);
      std::string message = error.what();
      const auto at = message.find(trial.string());
      if (at != std::string::npos) message.replace(at, trial.string().size(), path.string() + " (not written)");
      throw BadData(message);
    }
    std::filesystem::rename(trial, path);
    return;
  }
  write_file(path, text);
}

}  // namespace touchstone::importing
