// The program that talks to a CDash server and judges metrics over builds: touchstone-dashboard, and by a link
// touchstone-history.
#include "apps/program.h"
#include "dashboard_commands.h"

int main(int argc, char** argv) {
  return touchstone::apps::run_extra(argc, argv,
                                     {touchstone::dashboard::add_dashboard, touchstone::dashboard::add_history});
}
