#include "farm.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "harness/base/json_reader.h"
#include "harness/base/json_values.h"

namespace touchstone::runs {
namespace {

std::vector<std::string> texts(JsonObject& object, std::string_view key) {
  if (!object.has(key)) return {};
  std::vector<std::string> list = texts_of(object, key);
  if (std::ranges::any_of(list, [](const std::string& text) { return text.find('\n') != std::string::npos; }))
    object.fail_at(key, "texts of one line were expected");
  return list;
}

std::filesystem::path folder_of(const SlurmRequest& request) { return shard_file(request, 1).parent_path(); }

// A store on the node: fetch, run, take back. An unfinished transaction lies in a journal beside the file and goes with
// it, before it, since a file without its journal would be assumed whole.
constexpr const char* with_store = R"(file={}/touchstone-$(id -u)-$$-"$shard".sqlite
for end in -journal ''; do [ ! -e "$part$end" ] || cp "$part$end" "$file$end"; done
keep() {{
  [ ! -e "$file" ] || {{
    for end in -journal ''; do [ ! -e "$file$end" ] || cp "$file$end" "$part.new.$$$end"; done
    rm -f "$part-journal"
    for end in -journal ''; do [ ! -e "$part.new.$$$end" ] || mv "$part.new.$$$end" "$part$end"; done
  }}
  rm -f "$file" "$file-journal"
}}
trap keep EXIT
)";

std::string name_of(const SlurmRequest& request) { return "touchstone-" + request.words.front(); }

std::string kubernetes_job(const SlurmRequest& request, const FarmDescription& farm,
                           const std::vector<std::uint64_t>& shards, unsigned attempts) {
  const auto folder = folder_of(request).string();
  // The n-th line of shards.txt is the shard of completion n - 1.
  const std::string command =
      fmt::format("exec /bin/sh {} \"$(sed -n \"$((JOB_COMPLETION_INDEX + 1))p\" {})\"",
                  shell_quoted(task_file(request).string()), shell_quoted(folder + "/shards.txt"));
  const auto text = [](const std::string& value) { return nlohmann::json(value).dump(); };  // JSON is YAML
  return fmt::format(
      "apiVersion: batch/v1\n"
      "kind: Job\n"
      "metadata:\n"
      "  generateName: {}-\n"
      "spec:\n"
      "  completionMode: Indexed\n"
      "  completions: {}\n"
      "  parallelism: {}\n"
      "  backoffLimit: {}\n"
      "  template:\n"
      "    spec:\n"
      "      restartPolicy: Never\n"
      "      containers:\n"
      "      - name: shard\n"
      "        image: {}\n"
      "        command: [\"/bin/sh\", \"-c\", {}]\n"
      "        resources: {{requests: {{cpu: \"{}\"}}}}\n"
      "        volumeMounts: [{{name: data, mountPath: {}}}]\n"
      "      volumes: [{{name: data, persistentVolumeClaim: {{claimName: {}}}}}]\n",
      name_of(request), shards.size(), shards.size(), shards.size() * attempts, text(farm.image), text(command),
      request.cores_per_task, text(farm.mount), text(farm.claim));
}

}  // namespace

FarmDescription load_farm(const std::filesystem::path& file) {
  const auto json = load_json(file);
  JsonObject root(json, file.string(), "");
  root.schema("touchstone-farm/1");
  FarmDescription farm;
  farm.prologue = texts(root, "prologue");
  farm.inside = texts(root, "inside");
  farm.program = root.optional_text("program").value_or("");
  farm.node_store = root.optional_text("node_store").value_or("");
  // It stands within double quotes, where the shell expands names and nothing else may happen.
  if (farm.node_store.find_first_of("\"`\\\n") != std::string::npos ||
      farm.node_store.find("$(") != std::string::npos) {
    root.fail_at("node_store", "a folder was expected, with variables of the shell at most: ${TMPDIR:-/tmp}");
  }
  if (root.has("kubernetes")) {
    JsonObject kubernetes = root.object("kubernetes");
    farm.image = kubernetes.text("image");
    farm.claim = kubernetes.text("claim");
    farm.mount = kubernetes.text("mount");
    kubernetes.finish();
  }
  root.finish();
  return farm;
}

std::filesystem::path task_file(const SlurmRequest& request) { return folder_of(request) / "task.sh"; }

std::string task_script(const SlurmRequest& request, const FarmDescription& farm) {
  std::string script = fmt::format(
      "#!/bin/sh\n"
      "# Shard $1 of {}: may be run again, elsewhere and twice; it goes on where it stopped.\n"
      "set -e\n"
      "shard=${{1:?the number of a shard}}\n"
      "part={}/\"$shard\".sqlite\n",
      request.shards, shell_quoted(folder_of(request).string()));
  for (const std::string& line : farm.prologue) script += line + "\n";
  script += "set -u\n";  // what sites run before, Lmod's module among it, reads variables that are not set
  if (farm.node_store.empty()) {
    script += "file=$part\n";
  } else {
    script += fmt::format(with_store, fmt::format("\"{}\"", farm.node_store));
  }
  for (const std::string& word : farm.inside) script += shell_word(word) + ' ';
  script += shell_quoted(farm.program.empty() ? std::filesystem::absolute(request.program).string() : farm.program);
  for (const std::string& word : request.words) script += ' ' + shell_word(word);
  // In the background, so that a signal to the task is passed on at once.
  script += fmt::format(
      " --shard \"$shard/{}\" --threads {} {} \"$file\" &\n"
      "child=$!\n"
      "trap 'kill -TERM $child 2>/dev/null || true; wait $child || true; exit 143' TERM INT\n"
      "wait $child\n",
      request.shards, request.cores_per_task, request.file_option);
  return script;
}

std::vector<FarmFile> farm_files(const SlurmRequest& request, const FarmDescription& farm,
                                 const std::vector<std::uint64_t>& shards, unsigned attempts) {
  const auto folder = folder_of(request).string();
  std::string list;
  for (const std::uint64_t shard : shards) list += fmt::format("{}\n", shard);
  std::vector<FarmFile> files{{"task.sh", task_script(request, farm)}, {"shards.txt", list}};
  files.push_back({"jobs.sub", fmt::format("executable = /bin/sh\n"
                                           "arguments = \"'{0}/task.sh' $(shard)\"\n"
                                           "initialdir = {0}\n"
                                           "output = $(shard).log\n"
                                           "error = $(shard).log\n"
                                           "log = condor.log\n"
                                           "request_cpus = {1}\n"
                                           "max_retries = {2}\n"
                                           "should_transfer_files = NO\n"
                                           "queue shard from {0}/shards.txt\n",
                                           folder, request.cores_per_task, std::max(1U, attempts) - 1)});
  if (!farm.image.empty()) files.push_back({"job.yaml", kubernetes_job(request, farm, shards, attempts)});
  return files;
}

std::string farm_commands(const SlurmRequest& request, const FarmDescription& farm, unsigned attempts) {
  const auto folder = folder_of(request).string();
  std::string text = fmt::format(
      "GNU parallel  parallel --joblog {0}/parallel.log --retries {1} -a {0}/shards.txt /bin/sh "
      "{0}/task.sh\n"
      "HTCondor      condor_submit {0}/jobs.sub\n",
      shell_word(folder), std::max(1U, attempts));
  if (!farm.image.empty()) text += fmt::format("Kubernetes    kubectl create -f {}/job.yaml\n", shell_word(folder));
  return text;
}

}  // namespace touchstone::runs
