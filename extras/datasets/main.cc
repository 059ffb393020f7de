// The program touchstone-dataset, which is touchstone-synth too.
#include "apps/program.h"
#include "dataset_commands.h"

int main(int argc, char** argv) {
  return touchstone::apps::run_extra(argc, argv, {touchstone::datasets::add_dataset, touchstone::datasets::add_synth});
}
