// The program touchstone-leaderboard.
#include "apps/program.h"
#include "leaderboard_command.h"

int main(int argc, char** argv) {
  return touchstone::apps::run_extra(argc, argv, {touchstone::board::add_leaderboard});
}
