// The program with the command `evaluate` alone: it needs the fewest rooms, so that the first report of a fresh
// checkout does not wait for the compilation of the others.
#include "apps/commands.h"
#include "apps/program.h"

int main(int argc, char** argv) { return touchstone::apps::run_program(argc, argv, {touchstone::apps::add_evaluate}); }
