#include "framework/cli/main_program.hpp"

int main(int argc, char** argv) { return tomlin::program(argc, argv); }
