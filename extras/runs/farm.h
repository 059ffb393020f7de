// Many cases on any farm from one description: what a task does before and around the program (modules, a container, a
// store on the node itself), and the files with which GNU parallel, HTCondor and Kubernetes run one task for each
// shard. Every task is the same script with a shard's number, so that a shard may be run again, elsewhere, or twice.
// Sources: HTCondor's manual (condor_submit: "queue ... from", max_retries), Kubernetes' (batch/v1 Job with
// completionMode Indexed: JOB_COMPLETION_INDEX counts from 0), GNU parallel's (-a, --retries).
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "slurm.h"

namespace touchstone::runs {

// JSON, schema "touchstone-farm/1":
//   {"schema": "touchstone-farm/1",
//    "prologue": ["module load touchstone"],                 lines of shell before the program
//    "inside": ["apptainer", "exec", "/images/ts.sif"],      words before it
//    "program": "/usr/bin/touchstone",                       where the tasks find it; this program otherwise
//    "node_store": "${TMPDIR:-/tmp}",                        a folder of the node: results go there first
//    "kubernetes": {"image": "touchstone:0.1", "claim": "data", "mount": "/data"}}
struct FarmDescription {
  std::vector<std::string> prologue, inside;
  std::string program;
  std::string node_store;  // as the task's shell expands it; empty: results go straight to their place
  std::string image, claim, mount;
};

// Throws BadData naming the file and the place in it.
FarmDescription load_farm(const std::filesystem::path& file);

// The script that runs the shard of its first argument. With a store on the node the part is fetched from its place,
// and taken back when the program ends in whatever way, or the task is told to (SIGTERM); a node that is lost takes
// what it did of its shards since, which run again. Without one every row is in its place within a second.
std::string task_script(const SlurmRequest& request, const FarmDescription& farm);
std::filesystem::path task_file(const SlurmRequest& request);

struct FarmFile {
  std::string name;
  std::string text;
};
// task.sh, shards.txt, jobs.sub (HTCondor) and, where an image is named, job.yaml (Kubernetes).
std::vector<FarmFile> farm_files(const SlurmRequest& request, const FarmDescription& farm,
                                 const std::vector<std::uint64_t>& shards, unsigned attempts);
// What to type to run them, from any folder.
std::string farm_commands(const SlurmRequest& request, const FarmDescription& farm, unsigned attempts);

}  // namespace touchstone::runs
