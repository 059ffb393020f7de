#include "harness/bisection/measured_table.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"

namespace touchstone::bisection {

SearchLock::SearchLock(const std::filesystem::path& folder)
    : descriptor_(::open((folder / ".lock").c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0644)) {
  if (descriptor_ >= 0 && ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return;
  if (descriptor_ >= 0) ::close(descriptor_);
  throw UsageError(
      fmt::format("{}: another bisection is running there; wait for it, or give another --out", folder.string()));
}

SearchLock::~SearchLock() { ::close(descriptor_); }

MeasuredTable::MeasuredTable(std::filesystem::path file, const std::string& about) : file_(std::move(file)) {
  const std::string first = nlohmann::json{{"schema", "touchstone-bisection/1"}, {"search", about}}.dump();
  if (!std::filesystem::exists(file_)) {
    write_file(file_, first + "\n");
    return;
  }
  std::istringstream lines(read_file(file_));
  std::string line;
  std::getline(lines, line);
  if (line != first)
    throw UsageError(
        fmt::format("{}: holds another search; give another --out, or remove it\n  it holds: {}\n  wanted:   {}",
                    file_.string(), line, first));
  std::string sound = first + "\n";
  while (std::getline(lines, line)) {
    // The last line of a run that was killed may be cut.
    const auto entry = nlohmann::json::parse(line, nullptr, false);
    if (!entry.is_object() || !entry.contains("commit")) continue;
    try {
      MeasuredCommit& commit = commits_[entry.at("commit").get<std::string>()];
      if (entry.contains("value")) commit.values.push_back(entry.at("value").get<double>());
      if (entry.contains("broken")) commit.broken = entry.at("broken").get<std::string>();
    } catch (const nlohmann::json::exception& error) {
      throw BadData(fmt::format("{}: {}: not a measurement of a commit: {}; remove the line, or give another --out",
                                file_.string(), line, error.what()));
    }
    sound += line + "\n";
  }
  write_file(file_, sound, Replace::inputs_too);
}

void MeasuredTable::append(const std::string& line) {
  std::ofstream out(file_, std::ios::app);
  out << line << '\n';
  out.close();
  if (!out) throw BadData(fmt::format("{}: cannot be written; is the disk full?", file_.string()));
}

void MeasuredTable::add(const std::string& commit, double value) {
  if (!std::isfinite(value)) throw BadData(fmt::format("commit {}: the metric is {}", commit, value));
  const std::lock_guard lock(mutex_);
  append(nlohmann::json{{"commit", commit}, {"value", value}}.dump());
  commits_[commit].values.push_back(value);
}

void MeasuredTable::add_broken(const std::string& commit, const std::string& why) {
  const std::lock_guard lock(mutex_);
  append(nlohmann::json{{"commit", commit}, {"broken", why}}.dump());
  commits_[commit].broken = why;
}

MeasuredCommit MeasuredTable::find(const std::string& commit) const {
  const std::lock_guard lock(mutex_);
  const auto found = commits_.find(commit);
  return found == commits_.end() ? MeasuredCommit() : found->second;
}

std::size_t MeasuredTable::builds() const {
  const std::lock_guard lock(mutex_);
  return commits_.size();
}

std::size_t MeasuredTable::broken() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::size_t>(
      std::ranges::count_if(commits_, [](const auto& c) { return !c.second.broken.empty(); }));
}

}  // namespace touchstone::bisection
