// What the user sees: tables, targets and a picture drawn by gnuplot.
#pragma once

#include <string>
#include <vector>

#include "record.hpp"

namespace standing {

// Prints the figures and whether each target was met; true when all were that count.
// timing_counts: whether the targets of time do.
bool print_tables(const Summary& summary, const Plan& plan, bool timing_counts);

// Writes STEM.csv (every tick) and draws it as STEM.svg.
void write_files(const std::string& stem, const std::vector<Tick>& ticks, const Plan& plan, const Limits& there);

}  // namespace standing
