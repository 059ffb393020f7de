#include "harness/bisection/bisection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <thread>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/bisection/logged_program.h"
#include "harness/bisection/worktrees.h"

namespace touchstone::bisection {
namespace {

std::string short_name(const std::string& commit) { return commit.substr(0, 10); }

class Searcher {
 public:
  Searcher(const GitHistory& history, const BisectionRequest& request, const std::atomic<bool>& stop)
      : history_(&history),
        request_(&request),
        stop_(&stop),
        table_(request.out / "measured.jsonl",
               fmt::format("{} from {} to {}{}", request.metric, request.good, request.bad,
                           request.question.empty() ? "" : " by " + request.question)),
        trees_(history, request.out / "trees", std::max<std::size_t>(1, request.search.parallel)) {}

  // `at_good`: runs of the good end, where they are known without building it.
  MeasuredLine search(const std::string& good, const std::string& bad, const std::vector<double>& at_good = {}) {
    const auto commits = history_->line(good, bad);
    MeasuredLine line{commits, CommitCurve(commits.size())};
    for (std::size_t i = 0; i < commits.size(); ++i) take_known(line, i);
    if (!line.curve.measured(0)) {
      for (const double value : at_good) line.curve.add_run(0, value);
    }
    for (auto requests = next_requests(line.curve, request_->search); !requests.empty();
         requests = next_requests(line.curve, request_->search)) {
      measure(line, requests);
      for (const std::size_t end : {std::size_t{0}, commits.size() - 1}) {
        if (line.curve.broken(end)) {
          const std::string& commit = commits[end];
          throw BadData(fmt::format("the {} end, {}: {}; see {}", end == 0 ? "good" : "bad", short_name(commit),
                                    table_.find(commit).broken, log_of(commit).string()));
        }
      }
    }
    return line;
  }

  // The parts of a merge's step that its branches explain; the merge itself where they do not.
  void name_step(const MeasuredLine& line, const Step& step, const std::string& merge, double whole,
                 std::vector<NamedStep>& named) {
    const std::string& commit = line.commits[step.at];
    if (step.single()) {
      const auto branches = history_->merged(commit, line.commits[step.before]);
      bool explained = false;
      for (const auto& branch : branches) {
        request_->say(fmt::format("{} is a merge: searching what it brought", short_name(commit)));
        const MeasuredLine side = search_branch(branch, runs_near(line, branch.from));
        const SearchFindings found = conclude(side.curve, request_->search);
        if (!found.ends_differ || std::abs(found.bad - found.good - step.excess) > 0.5 * std::abs(step.excess))
          continue;
        for (Step part : found.steps) {
          part.share = part.excess / whole;
          name_step(side, part, commit, whole, named);
        }
        explained = explained || !found.steps.empty();
      }
      if (explained) return;
      named.push_back({step, {commit}, history_->title(commit), merge, !branches.empty()});
      return;
    }
    NamedStep several{step, {}, history_->title(commit), merge};
    for (std::size_t i = step.before + 1; i <= step.at; ++i) several.commits.push_back(line.commits[i]);
    named.push_back(std::move(several));
  }

  [[nodiscard]] std::size_t builds() const { return table_.builds(); }
  [[nodiscard]] std::size_t broken() const { return table_.broken(); }

 private:
  // A branch of which an end cannot be measured explains nothing.
  MeasuredLine search_branch(const GitHistory::Branch& branch, const std::vector<double>& at_start) {
    try {
      return search(branch.from, branch.to, at_start);
    } catch (const BadData& error) {
      request_->say(error.what());
      return {{branch.from, branch.to}, CommitCurve(2)};
    }
  }

  // A branch begins on the line as a rule. Between two measured commits that are alike, its beginning is as they are.
  [[nodiscard]] std::vector<double> runs_near(const MeasuredLine& line, const std::string& commit) const {
    const auto found = std::ranges::find(line.commits, commit);
    if (found == line.commits.end()) return {};
    const auto position = static_cast<std::size_t>(found - line.commits.begin());
    std::size_t before = position;
    std::size_t after = position;
    while (!line.curve.measured(before)) --before;
    while (!line.curve.measured(after)) ++after;
    const double matters = conclude(line.curve, request_->search).matters;
    if (std::abs(line.curve.change(before, after)) > 0.5 * matters) return {};
    auto runs = table_.find(line.commits[before]).values;
    // One run without noise stands for as many as the search asks of an end.
    if (line.curve.noise() <= 0.0 && runs.size() == 1) runs.push_back(runs.front());
    return runs;
  }

  void take_known(MeasuredLine& line, std::size_t position) const {
    const MeasuredCommit known = table_.find(line.commits[position]);
    if (!known.broken.empty()) line.curve.set_broken(position);
    for (std::size_t i = line.curve.runs(position); i < known.values.size(); ++i)
      line.curve.add_run(position, known.values[i]);
  }

  void measure(MeasuredLine& line, const std::vector<MeasureRequest>& requests) {
    std::atomic<std::size_t> next = 0;
    std::mutex mutex;
    std::exception_ptr thrown;
    const auto work = [&] {
      for (std::size_t i = next++; i < requests.size(); i = next++) {
        try {
          measure_commit(line.commits[requests[i].position], requests[i].runs);
        } catch (...) {
          const std::lock_guard lock(mutex);
          if (!thrown) thrown = std::current_exception();
          return;
        }
      }
    };
    std::vector<std::thread> workers;
    for (std::size_t i = 1; i < std::min(request_->search.parallel, requests.size()); ++i) workers.emplace_back(work);
    work();
    for (std::thread& worker : workers) worker.join();
    if (thrown) std::rethrow_exception(thrown);
    for (const MeasureRequest& request : requests) take_known(line, request.position);
  }

  [[nodiscard]] std::filesystem::path log_of(const std::string& commit) const {
    return request_->out / "logs" / (short_name(commit) + ".txt");
  }

  void measure_commit(const std::string& commit, std::size_t runs) {
    const Worktrees::Checkout tree(trees_, commit);
    BuiltCommit built{commit, tree.source(), tree.build(), request_->out / "commits" / short_name(commit),
                      {},     log_of(commit)};
    ensure_writable_folder(built.work);
    ensure_writable_folder(built.log.parent_path());
    built.environment = {{"SRC", built.source.string()},
                         {"BUILD", built.build.string()},
                         {"WORK", built.work.string()},
                         {"COMMIT", commit}};
    request_->say(fmt::format("building {} {}", short_name(commit), history_->title(commit)));
    if (!succeeds(shell_command(request_->build_command, built, *stop_))) {
      table_.add_broken(commit, "does not build");
      return;
    }
    std::string values;
    for (std::size_t i = 0; i < runs; ++i) {
      const auto value = request_->measure(built, *stop_);
      if (!value || !std::isfinite(*value)) {
        table_.add_broken(commit, "does not run");
        return;
      }
      table_.add(commit, *value);
      values += fmt::format(" {:.6g}", *value);
    }
    request_->say(fmt::format("{}: {}{}", short_name(commit), request_->metric, values));
  }

  const GitHistory* history_;
  const BisectionRequest* request_;
  const std::atomic<bool>* stop_;
  MeasuredTable table_;
  Worktrees trees_;
};

}  // namespace

BisectionAnswer bisect(const GitHistory& history, const BisectionRequest& request, const std::atomic<bool>& stop) {
  ensure_writable_folder(request.out);
  Searcher searcher(history, request, stop);
  MeasuredLine line = searcher.search(request.good, request.bad);
  const SearchFindings findings = conclude(line.curve, request.search);
  BisectionAnswer answer{request.metric, findings, std::move(line), {}, {}};
  const double whole = answer.findings.bad - answer.findings.good;
  for (const Step& step : answer.findings.steps) searcher.name_step(answer.line, step, "", whole, answer.steps);
  for (const Drift& drift : answer.findings.drifts)
    answer.drifts.push_back({drift, answer.line.commits[drift.first + 1], answer.line.commits[drift.last]});
  answer.builds = searcher.builds();
  answer.broken = searcher.broken();
  return answer;
}

}  // namespace touchstone::bisection
