#include "harness/recording/csv_source.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <string_view>

#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

// No recording has a longer line: a file that does is not one, and memory stays bounded.
constexpr std::size_t buffer_size = std::size_t{1} << 20;

std::string_view trim(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

// A value for a message: short, and nothing in it that disturbs a terminal.
std::string shown(std::string_view text) {
  constexpr std::size_t longest = 40;
  std::string result;
  for (const char c : text.substr(0, longest)) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) {
      result += fmt::format("\\x{:02x}", byte);
    } else {
      result += c;
    }
  }
  return text.size() > longest ? result + "..." : result;
}

constexpr std::string_view wanted_header =
    "a recording begins with the names of its columns, quantity and unit, for instance t_s,x_m,y_m,z_m,fx_N,fy_N,fz_N";

// What to do with a file whose first line is no header: what stands there, and both ways out of it.
std::string no_header(const std::string& file, std::string_view what, std::string_view by_hand) {
  return fmt::format("{}: {}; {}. {}, or let `touchstone import {} --guess` propose how to read it", file, what,
                     wanted_header, by_hand, file);
}

// The sign that a line of many loggers begins with where it holds no data; empty where it is none of them.
std::string_view comment_sign(std::string_view line) {
  for (const std::string_view sign : {"#", "%", "//", "!"}) {
    if (line.starts_with(sign)) return sign;
  }
  return {};
}

class CsvSource final : public TableSource {
 public:
  explicit CsvSource(const std::filesystem::path& path)
      : name_(path.string()), file_(gzopen(path.c_str(), "rb")), buffer_(buffer_size) {
    if (file_ == nullptr) throw BadData(fmt::format("{}: cannot be opened: {}", name_, std::strerror(errno)));
    gzbuffer(file_, 1U << 18);
    try {
      read_header();
    } catch (...) {
      gzclose_r(file_);
      throw;
    }
  }
  ~CsvSource() override { gzclose_r(file_); }
  CsvSource(const CsvSource&) = delete;
  CsvSource& operator=(const CsvSource&) = delete;

  const std::vector<std::string>& names() const noexcept override { return names_; }
  const std::vector<std::string>& notes() const noexcept override { return notes_; }
  std::string format() const override { return gzdirect(file_) != 0 ? "CSV" : "CSV, gzip"; }
  std::string name_place(std::size_t column) const override {
    return fmt::format("{}: line 1, column {}", name_, column + 1);
  }
  std::string value_place(std::uint64_t row, std::size_t column) const override {
    return fmt::format("{}: line {}, column {} ({})", name_, row + 2, column + 1, names_[column]);
  }
  std::string row_name(std::uint64_t row) const override { return fmt::format("line {}", row + 2); }

  std::size_t read(std::size_t max_rows, std::span<std::vector<double>> columns) override {
    std::size_t rows = 0;
    std::string_view line;
    while (rows < max_rows && next_line(line)) {
      if (trim(line).empty()) {
        require_end();
        break;
      }
      parse_row(line, columns);
      ++row_;
      ++rows;
    }
    return rows;
  }

 private:
  // Fills the buffer behind what is unread. False at the end of the file.
  bool fill() {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
    if (end_ == buffer_.size()) {
      throw BadData(fmt::format("{}: line {} is longer than {} bytes; this is not a recording", name_, line_ + 1,
                                buffer_.size()));
    }
    const int got = gzread(file_, buffer_.data() + end_, static_cast<unsigned>(buffer_.size() - end_));
    int status = Z_OK;
    const char* const reason = gzerror(file_, &status);
    if (got < 0 || (status != Z_OK && status != Z_STREAM_END)) {
      throw BadData(fmt::format("{}: cannot be read after line {}: {}; is the file complete?", name_, line_,
                                status == Z_ERRNO ? std::strerror(errno) : reason));
    }
    end_ += static_cast<std::size_t>(got);
    return got > 0;
  }

  // The next line without its end; false at the end of the file. The view holds until the next call.
  bool next_line(std::string_view& line) {
    std::size_t searched = begin_;
    for (;;) {
      const char* const from = buffer_.data() + searched;
      const auto* const newline = static_cast<const char*>(std::memchr(from, '\n', end_ - searched));
      if (newline != nullptr) {
        const char* const start = buffer_.data() + begin_;
        line = std::string_view(start, static_cast<std::size_t>(newline - start));
        begin_ += line.size() + 1;
        break;
      }
      searched = end_ - begin_;
      if (fill()) continue;
      if (begin_ == end_) return false;
      line = std::string_view(buffer_.data() + begin_, end_ - begin_);
      begin_ = end_;
      cut_ = true;
      notes_.push_back(
          fmt::format("{}: no line end after the last line; if the file was cut short, its last value is "
                      "wrong",
                      name_));
      break;
    }
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    ++line_;
    return true;
  }

  // Blank lines may only end a file.
  void require_end() {
    const std::uint64_t blank = line_;
    std::string_view line;
    while (next_line(line)) {
      if (trim(line).empty()) continue;
      throw BadData(
          fmt::format("{}: line {} is blank but line {} is not; a blank line may only end a file: was a "
                      "sample lost?",
                      name_, blank, line_));
    }
    begin_ = end_;
  }

  void read_header() {
    std::string_view line;
    if (!next_line(line)) throw BadData(fmt::format("{}: is empty; a header line of column names was expected", name_));
    if (line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    if (line.starts_with("\xff\xfe") || line.starts_with("\xfe\xff")) {
      throw BadData(fmt::format("{}: is UTF-16 text; save it as UTF-8 or ASCII", name_));
    }
    if (trim(line).empty()) throw BadData(no_header(name_, "line 1 is blank", "Delete the blank lines before it"));
    if (line.find('\r') != std::string_view::npos) {
      throw BadData(
          fmt::format("{}: lines end in bare carriage returns; save it with Unix or Windows line ends", name_));
    }
    if (std::ranges::any_of(line, [](char c) { return static_cast<unsigned char>(c) < 0x20 && c != '\t'; })) {
      throw BadData(fmt::format("{}: line 1 is not text ('{}'); this is not a CSV file", name_, shown(line)));
    }
    if (const auto sign = comment_sign(trim(line)); !sign.empty()) {
      throw BadData(no_header(name_, fmt::format("line 1 is a comment ('{}')", shown(trim(line))),
                              fmt::format("Delete the lines that begin with {}", sign)));
    }
    choose_separator(line);
    while (true) {
      const auto at = line.find(separator_);
      std::string_view name = trim(line.substr(0, at));
      if (name.size() >= 2 && name.front() == '"' && name.back() == '"') name = name.substr(1, name.size() - 2);
      names_.push_back(shown(name));
      if (at == std::string_view::npos) break;
      line.remove_prefix(at + 1);
    }
    if (!names_.empty() && std::ranges::all_of(names_, [](const std::string& name) {
          double ignored = 0.0;
          return !name.empty() && std::from_chars(name.data(), name.data() + name.size(), ignored).ec == std::errc{};
        })) {
      throw BadData(no_header(name_, fmt::format("has no header: line 1 holds numbers, {} of them", names_.size()),
                              "Put a line with the names of the columns before it"));
    }
  }

  void choose_separator(std::string_view header) {
    if (header.find(',') != std::string_view::npos) return;
    for (const auto& [separator, what] : {std::pair{';', "semicolons"}, std::pair{'\t', "tabs"}}) {
      if (header.find(separator) == std::string_view::npos) continue;
      separator_ = separator;
      notes_.push_back(fmt::format("{}: values are separated by {}", name_, what));
      return;
    }
  }

  void parse_row(std::string_view line, std::span<std::vector<double>> columns) {
    const char* at = line.data();
    const char* const end = line.data() + line.size();
    for (std::size_t i = 0; i < columns.size(); ++i) {
      while (at != end && (*at == ' ' || (*at == '\t' && separator_ != '\t'))) ++at;
      const char* const start = at;
      double value = 0.0;
      const bool quoted = at != end && *at == '"';
      if (quoted) ++at;
      // from_chars takes no plus sign; other programs write one.
      const bool plus = at != end && *at == '+' && end - at > 1 && at[1] != '-';
      const auto [rest, status] = std::from_chars(plus ? at + 1 : at, end, value);
      at = rest;
      const bool closed = !quoted || (at != end && *at == '"');
      if (quoted && closed) ++at;
      while (at != end && (*at == ' ' || (*at == '\t' && separator_ != '\t'))) ++at;
      const bool last = i + 1 == columns.size();
      if (status == std::errc{} && closed && (last ? at == end : (at != end && *at == separator_))) {
        columns[i].push_back(value);
        ++at;
        continue;
      }
      fail(line, i, start);
    }
  }

  [[noreturn]] void fail(std::string_view line, std::size_t column, const char* start) const {
    const auto found = static_cast<std::size_t>(std::ranges::count(line, separator_)) + 1;
    const std::string cut = cut_ ? "; the file ends there without a line end: was it cut short?" : "";
    if (found != names_.size()) {
      const bool decimal_comma = separator_ == ',' && found > names_.size();
      throw BadData(fmt::format("{}: line {} has {} value{} where the header names {} columns{}{}", name_, line_, found,
                                found == 1 ? "" : "s", names_.size(), cut,
                                decimal_comma ? "; numbers must be written with a decimal point" : ""));
    }
    const std::string_view rest(start, static_cast<std::size_t>(line.data() + line.size() - start));
    const std::string_view text = trim(rest.substr(0, rest.find(separator_)));
    const std::string where = value_place(row_, column);
    if (text.empty()) throw BadData(fmt::format("{}: the value is missing{}", where, cut));
    double value = 0.0;
    const auto [stop, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status == std::errc::result_out_of_range) {
      throw BadData(fmt::format("{}: '{}' is beyond what a double can hold", where, shown(text)));
    }
    if (text.find(',') != std::string_view::npos) {
      throw BadData(fmt::format("{}: '{}' is not a number: write it with a decimal point", where, shown(text)));
    }
    throw BadData(fmt::format("{}: '{}' is not a number{}", where, shown(text), cut));
  }

  std::string name_;
  gzFile file_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // unread bytes of the buffer
  std::size_t end_ = 0;
  std::uint64_t line_ = 0;  // lines read
  std::uint64_t row_ = 0;   // samples read
  bool cut_ = false;        // the last line had no line end
  char separator_ = ',';
  std::vector<std::string> names_;
  std::vector<std::string> notes_;
};

}  // namespace

std::unique_ptr<TableSource> open_csv_source(const std::filesystem::path& path) {
  return std::make_unique<CsvSource>(path);
}

}  // namespace touchstone::recording
