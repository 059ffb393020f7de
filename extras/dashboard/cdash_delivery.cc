#include "cdash_delivery.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "harness/base/atomic_file.h"
#include "harness/base/error.h"
#include "harness/base/md5.h"

namespace touchstone::dashboard {
namespace {

using nlohmann::json;

constexpr int refusals_allowed = 3;

enum class SendResult : unsigned char { answered, unknown, refused, stopped };

// The whole text of an element of the answer, "" if it has none.
std::string element_of(const std::string& xml, const std::string& name) {
  const auto begin = xml.find("<" + name + ">");
  const auto end = xml.find("</" + name + ">");
  if (begin == std::string::npos || end == std::string::npos || end < begin) return "";
  return xml.substr(begin + name.size() + 2, end - begin - name.size() - 2);
}

class Courier {
 public:
  Courier(CdashConnection& connection, const DashboardRun& run, const DeliveryOptions& options)
      : connection_(connection), run_(run), options_(options) {}

  Delivery go() {
    try {
      read();
      if (build_ && is_done() && !complete()) replace();
      // Twice: the second time after a replacement, or for parts whose answer was lost.
      for (int round = 0; round < 2; ++round) {
        if (!send_missing()) return result_;
        if (!readable_) return unreadable();
        wait_for([&] { return settled(); });
        if (complete()) break;
        if (doubled() && !replace()) return result_;
      }
      if (!complete()) return incomplete();
      finish();
    } catch (const BadData& error) {
      result_.problems.emplace_back(error.what());
    }
    return result_;
  }

 private:
  [[nodiscard]] std::filesystem::path note(const std::string& part) const { return run_.folder / "sent" / part; }
  [[nodiscard]] std::string noted(const std::string& part) const {
    return std::filesystem::exists(note(part)) ? read_file(note(part)) : "";
  }
  void write_note(const std::string& part, const std::string& text) const {
    std::filesystem::create_directories(run_.folder / "sent");
    write_file(note(part), text);
  }

  // The build as the server has it now.
  void read() {
    const auto& name = run_.build;
    const json data = connection_.graphql(fmt::format(
        "{{ project(name: {}) {{ builds(first: 100, filters: {{all: [{{eq: {{stamp: {}}}}}, {{eq: {{name: {}}}}}]}}) "
        "{{ edges {{ node {{ {} }} }} }} }} }}",
        graphql_text(connection_.server().project), graphql_text(name.stamp), graphql_text(name.name),
        remote_fields()));
    build_.reset();
    try {
      readable_ = !data.at("project").is_null();
      if (!readable_) return;
      for (const auto& edge : data.at("project").at("builds").at("edges")) {
        if (edge.at("node").at("site").at("name") == name.site) build_ = edge.at("node");
      }
      if (build_) result_.build_id = build_->at("id").get<std::string>();
    } catch (const json::exception& error) {
      throw BadData(
          fmt::format("{}: the answer is not what CDash's GraphQL gives: {}", connection_.server().url, error.what()));
    }
  }

  // Not in GraphQL of 5.3: the list of a day's builds says it. A testing day begins at the project's nightly time, so
  // the neighbouring days are asked too.
  bool is_done() {
    if (!build_) return false;
    const auto text = build_->at("startTime").get<std::string>();
    const std::chrono::year_month_day day(std::chrono::year(std::stoi(text.substr(0, 4))),
                                          std::chrono::month(static_cast<unsigned>(std::stoi(text.substr(5, 2)))),
                                          std::chrono::day(static_cast<unsigned>(std::stoi(text.substr(8, 2)))));
    for (const int shift : {0, -1, 1}) {
      const std::chrono::year_month_day at(std::chrono::sys_days(day) + std::chrono::days(shift));
      const json answer = connection_.get(fmt::format(
          "/api/v1/index.php?project={}&date={:04}-{:02}-{:02}", percent_encoded(connection_.server().project),
          static_cast<int>(at.year()), static_cast<unsigned>(at.month()), static_cast<unsigned>(at.day())));
      if (!answer.is_object() || !answer.contains("buildgroups")) continue;
      for (const auto& group : answer["buildgroups"]) {
        for (const auto& build : group.value("builds", json::array())) {
          if (build.value("id", json()).dump() != result_.build_id) continue;
          const json done = build.value("done", json(false));
          return done.is_boolean() ? done.get<bool>() : done.dump().find('1') != std::string::npos;
        }
      }
    }
    return false;
  }

  [[nodiscard]] bool is_set_aside(const DashboardPart& part) const {
    return std::filesystem::exists(run_.folder / "set-aside" / part.name);
  }
  [[nodiscard]] std::optional<std::size_t> shown(const DashboardPart& part) const {
    return build_ ? remote_rows(*build_, part) : std::nullopt;
  }
  [[nodiscard]] bool complete() const {
    return build_ && std::ranges::all_of(run_.parts, [&](const DashboardPart& part) {
             return is_set_aside(part) || shown(part) == part.rows;
           });
  }
  // What can come has come.
  [[nodiscard]] bool settled() const {
    return build_ && std::ranges::all_of(run_.parts, [&](const DashboardPart& part) {
             return is_set_aside(part) || refused_.contains(part.name) || shown(part).value_or(0) >= part.rows;
           });
  }
  [[nodiscard]] bool doubled() const {
    return std::ranges::any_of(run_.parts,
                               [&](const DashboardPart& part) { return shown(part).value_or(0) > part.rows; });
  }

  template <class Condition>
  bool wait_for(const Condition& condition) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(options_.wait_s);
    while (true) {
      read();
      if (condition()) return true;
      if (std::chrono::steady_clock::now() >= end) return false;
      std::this_thread::sleep_for(std::chrono::duration<double>(options_.poll_s));
    }
  }

  // Sends what the server does not show. False: nothing more can be done now.
  bool send_missing() {
    for (const DashboardPart& part : run_.parts) {
      if (is_set_aside(part) || refused_.contains(part.name)) continue;
      const std::string before = noted(part.name);
      if (readable_ && shown(part)) continue;
      if (before.starts_with("answered") && !readable_) {
        if (const auto space = before.find(' '); space != std::string::npos)
          result_.build_id = before.substr(space + 1);
        continue;
      }
      if (before.starts_with("answered") || before.starts_with("unknown")) {
        if (!readable_)
          return stop(fmt::format("{}: its answer was lost, and the build cannot be read back", part.name));
        // It may be waiting in the server's queue: sending it again would double its rows.
        if (wait_for([&] { return shown(part).has_value(); })) continue;
        if (before.starts_with("answered")) {
          not_shown(part);
          continue;
        }
      }
      if (send_part(part)) continue;
      // Its answer was lost: if it arrived, the server shows it.
      if (!readable_ || !noted(part.name).starts_with("unknown") || !wait_for([&] { return shown(part).has_value(); }))
        return false;
      result_.problems.pop_back();
    }
    return true;
  }

  // The server said OK, and the part does not come. If all others came, its handler failed on this one.
  void not_shown(const DashboardPart& part) {
    const bool others = std::ranges::all_of(run_.parts, [&](const DashboardPart& other) {
      return other.name == part.name || is_set_aside(other) || shown(other) == other.rows;
    });
    const auto rows = shown(part).value_or(0);
    if (!others) {
      stop(fmt::format("{}: {} of {} rows arrived within {:g} s: the server's queue is slow or stands still", part.name,
                       rows, part.rows, options_.wait_s));
      return;
    }
    refused_.insert_or_assign(
        part.name, fmt::format("the server said OK, and {} of {} rows arrived{}", rows, part.rows,
                               part.kind == PartKind::upload
                                   ? ": is the project's upload quota too small (touchstone dashboard init), or has a "
                                     "file no extension?"
                                   : ""));
  }

  // False: nothing more can be sent now.
  bool send_part(const DashboardPart& part) {
    const SendResult result = send(part.name, part.file_name, part.xml);
    if (result == SendResult::refused) refused_.insert_or_assign(part.name, why_);
    return result == SendResult::answered || result == SendResult::refused;
  }

  // A refusal counts if the server took something else of this run: else it is the server that is ill, not the part.
  // The last refusal allowed sets the part aside.
  void count_refusals() {
    const bool works = std::ranges::any_of(run_.parts, [&](const DashboardPart& part) {
      return !refused_.contains(part.name) && shown(part).has_value();
    });
    for (const auto& [part, why] : refused_) {
      if (!works) {
        stop(fmt::format("{} was not taken: {}", part, why));
        continue;
      }
      const auto count_file = run_.folder / "refusals" / part;
      const int count = 1 + (std::filesystem::exists(count_file) ? std::stoi("0" + read_file(count_file)) : 0);
      std::filesystem::create_directories(count_file.parent_path());
      write_file(count_file, std::to_string(count));
      if (count < refusals_allowed) {
        stop(fmt::format("{} was not taken ({} of {}): {}", part, count, refusals_allowed, why));
        continue;
      }
      std::filesystem::create_directories(run_.folder / "set-aside");
      write_file(run_.folder / "set-aside" / part, why);
    }
  }

  bool stop(std::string problem) {
    result_.problems.push_back(std::move(problem));
    return false;
  }

  SendResult send(const std::string& part, const std::string& file_name, const std::string& xml) {
    const auto& name = run_.build;
    write_note(part, "unknown\n");
    const WebAnswer answer = connection_.submit(
        fmt::format("&FileName={}&build={}&site={}&stamp={}&MD5={}",
                    percent_encoded(name.site + "___" + name.name + "___" + name.stamp + "___XML___" + file_name),
                    percent_encoded(name.name), percent_encoded(name.site), percent_encoded(name.stamp), md5(xml)),
        xml);
    if (answer.outcome == WebOutcome::unreachable) {
      std::filesystem::remove(note(part));
      stop(fmt::format("{}: {}", connection_.server().url, answer.problem));
      return SendResult::stopped;
    }
    if (answer.outcome != WebOutcome::answered) {
      stop(fmt::format("{}: the answer was lost: {}", part, answer.problem));
      return SendResult::unknown;
    }
    if (answer.status == 200 && element_of(answer.text, "status") == "OK") {
      if (const auto id = element_of(answer.text, "buildId"); !id.empty()) result_.build_id = id;
      write_note(part, "answered " + result_.build_id);
      return SendResult::answered;
    }
    std::filesystem::remove(note(part));
    return judge_refusal(part, answer);
  }

  SendResult judge_refusal(const std::string& part, const WebAnswer& answer) {
    const std::string words = answer.text.substr(0, 200);
    const auto every = [&](const std::string& why) {
      stop(fmt::format("{} was not taken: {}", part, why));
      return SendResult::stopped;
    };
    if (answer.status == 200)
      return every(
          fmt::format("the answer does not come from CDash but begins '{}': a log-in or maintenance page?", words));
    if (answer.status == 401 || answer.status == 403)
      return every(
          fmt::format("the token is missing or wrong: set TOUCHSTONE_CDASH_TOKEN ({}: {})", answer.status, words));
    if (answer.status == 404)
      return every(fmt::format("no such project on that server: see TOUCHSTONE_CDASH_PROJECT, now '{}' ({})",
                               connection_.server().project, words));
    why_ = fmt::format("the server answers {}: {}", answer.status, words);
    return SendResult::refused;
  }

  // Ends the build as it is, and begins anew: the first part after Done makes the server delete it.
  bool replace() {
    if (replaced_ || !build_) return stop("the build holds rows twice, also after it was replaced");
    replaced_ = true;
    if (!is_done() && !end_build())
      return stop(fmt::format(
          "build {} holds rows twice and cannot be replaced, for the server does not end it: delete it there",
          result_.build_id));
    const std::string old = result_.build_id;
    std::filesystem::remove_all(run_.folder / "sent");
    const auto first = std::ranges::find_if(run_.parts, [&](const DashboardPart& p) { return !is_set_aside(p); });
    if (first == run_.parts.end() || !send_part(*first)) return false;
    return wait_for([&] { return build_ && result_.build_id != old; }) ||
           stop(fmt::format("build {} was to be replaced and is still there", old));
  }

  bool end_build() {
    // In the server's queue already: a second one would keep the first from its end.
    if (noted("Done").starts_with("answered") && wait_for([&] { return is_done(); })) return true;
    for (int attempt = 0; attempt < 2; ++attempt) {
      const SendResult sent = send("Done", "Done.xml", done_xml(build_->at("id").get<std::string>()));
      if (sent == SendResult::stopped || sent == SendResult::refused) return false;
      if (wait_for([&] { return is_done(); })) return true;
      if (sent == SendResult::answered) break;  // Done may be sent again where its answer was lost, and only there
    }
    return mark_done() && wait_for([&] { return is_done(); });
  }

  // A part on which the server failed keeps the count of pending files up, and the build open; a project's
  // administrator may end it by hand (api/v1/build.php).
  bool mark_done() {
    try {
      connection_.send_form("/api/v1/build.php", {{"buildid", result_.build_id}, {"done", "1"}});
      return true;
    } catch (const BadData&) {
      return false;
    }
  }

  void finish() {
    const bool done = is_done() || end_build();
    read();
    if (!complete()) {
      stop(fmt::format("build {} was whole and no longer is", result_.build_id));
      return;
    }
    result_.problems.clear();  // what was waited for has come
    for (const DashboardPart& part : run_.parts) {
      if (is_set_aside(part))
        result_.problems.push_back(
            fmt::format("{} is set aside: {}", part.name, read_file(run_.folder / "set-aside" / part.name)));
    }
    if (!done) {
      if (result_.problems.empty()) {
        stop(fmt::format("build {} holds everything, and the server does not end it", result_.build_id));
        return;
      }
      result_.problems.push_back(fmt::format("build {} stays open on the server", result_.build_id));
    }
    result_.outcome = result_.problems.empty() ? Delivered::whole : Delivered::set_aside;
  }

  Delivery unreadable() {
    if (options_.trust_answers && refused_.empty()) {
      if (send("Done", "Done.xml", done_xml(result_.build_id)) == SendResult::answered)
        result_.outcome = Delivered::unverified;
      return result_;
    }
    stop(fmt::format(
        "every part was taken, and project '{}' cannot be read back with this token: give one that may read, or "
        "trust the answers (--trust-answers)",
        connection_.server().project));
    return result_;
  }

  Delivery incomplete() {
    for (const DashboardPart& part : run_.parts) {
      if (!is_set_aside(part) && !refused_.contains(part.name) && shown(part) != part.rows) not_shown(part);
    }
    count_refusals();
    if (complete()) finish();  // what was missing is set aside now
    return result_;
  }

  CdashConnection& connection_;
  const DashboardRun& run_;
  DeliveryOptions options_;
  Delivery result_;
  std::optional<json> build_;
  std::map<std::string, std::string> refused_;  // in this run, and why
  std::string why_;
  bool readable_ = false;
  bool replaced_ = false;
};

}  // namespace

Delivery deliver(CdashConnection& connection, const DashboardRun& run, const DeliveryOptions& options) {
  return Courier(connection, run, options).go();
}

}  // namespace touchstone::dashboard
