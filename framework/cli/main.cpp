#include "framework/cli/program.hpp"

int main(int argc, char** argv) { return tomlin::program(argc, argv); }
