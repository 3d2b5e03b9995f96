// dalembert: arguments → one command → exit code. 0 good, 1 a check failed, 2 bad input or usage.
#include "commands/command_line.hpp"

int main(int argc, char** argv) { return dalembert::run(argc, argv); }
