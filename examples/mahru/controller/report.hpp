// What the user sees: a table, and a picture drawn by gnuplot.
#pragma once

#include <string>
#include <vector>

#include "record.hpp"

namespace controller {

// Prints the figures and whether each target was met; true when all were that count.
// timing_counts: whether the targets of time do.
bool print_table(const Summary& summary, Base base, const char* const* joint_names, bool timing_counts);

// Writes DIR/mahru_BASE.csv (every tick) and draws it as DIR/mahru_BASE.svg. A missing gnuplot is a notice, not an error.
void write_files(const std::string& directory, const std::vector<Tick>& ticks, Base base, const char* const* joint_names);

}  // namespace controller
