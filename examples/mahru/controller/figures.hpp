// Lines of a report, and pictures drawn by gnuplot.
#pragma once

#include <string>

#include "record.hpp"

namespace controller {

bool verdict(const std::string& what, bool met);  // prints a target and whether it is met; returns that
void print_header();                              // over rows of times
void print_row(const char* what, const Percentiles& p);
std::string quoted(const std::string& text);  // a single-quoted string of gnuplot's

// Lets gnuplot run a script that writes `picture`, and says where it is. A missing gnuplot is a notice, not an error.
void draw(const std::string& script, const std::string& picture);

}  // namespace controller
