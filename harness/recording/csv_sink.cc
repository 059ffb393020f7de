#include "harness/recording/csv_sink.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::recording {
namespace {

class CsvSink final : public TableSink {
 public:
  CsvSink(const std::filesystem::path& path, const std::vector<Column>& columns, bool gzip)
      // 'T' writes without compression.
      : name_(path.string()), atomic_(path), file_(gzopen(atomic_.path().c_str(), gzip ? "wb6" : "wbT")) {
    if (file_ == nullptr) fail();
    gzbuffer(file_, 1U << 18);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (i > 0) text_ += ',';
      text_ += columns[i].name;
    }
    text_ += '\n';
  }
  ~CsvSink() override {
    if (file_ != nullptr) gzclose_w(file_);
  }
  CsvSink(const CsvSink&) = delete;
  CsvSink& operator=(const CsvSink&) = delete;

  void write(std::span<const std::vector<double>> columns) override {
    // The longest double has 24 characters.
    char number[32];
    for (std::size_t row = 0; row < columns.front().size(); ++row) {
      for (std::size_t i = 0; i < columns.size(); ++i) {
        // The shortest text that reads back as the same double.
        const auto end = std::to_chars(number, number + sizeof number - 1, columns[i][row]).ptr;
        *end = i + 1 == columns.size() ? '\n' : ',';
        text_.append(number, end + 1);
      }
      if (text_.size() > (1U << 16)) flush();
    }
  }

  void commit() override {
    flush();
    errno = 0;
    const int status = gzclose_w(std::exchange(file_, nullptr));
    if (status != Z_OK) fail();
    atomic_.commit();
  }

 private:
  void flush() {
    errno = 0;
    if (!text_.empty() && gzwrite(file_, text_.data(), static_cast<unsigned>(text_.size())) <= 0) fail();
    text_.clear();
  }

  [[noreturn]] void fail() const {
    throw BadData(fmt::format("{}: cannot be written: {}", name_, errno != 0 ? std::strerror(errno) : "zlib failed"));
  }

  std::string name_;
  AtomicFile atomic_;
  gzFile file_;
  std::string text_;
};

}  // namespace

std::unique_ptr<TableSink> create_csv_sink(const std::filesystem::path& path, const std::vector<Column>& columns,
                                           bool gzip) {
  return std::make_unique<CsvSink>(path, columns, gzip);
}

}  // namespace touchstone::recording
