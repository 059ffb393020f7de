// The program that makes recordings of raw streams, touchstone-acquire.
#include "acquire_command.h"
#include "apps/program.h"

int main(int argc, char** argv) {
  return touchstone::apps::run_extra(argc, argv, {touchstone::acquisition::add_acquire});
}
