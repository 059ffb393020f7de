// The program of data-driven textures, touchstone-texture.
#include "apps/program.h"
#include "command_texture.h"

int main(int argc, char** argv) { return touchstone::apps::run_extra(argc, argv, {touchstone::texture::add_texture}); }
