#include "figures.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace controller {

bool verdict(const std::string& what, bool met) {
  fmt::print("  {:<58} {}\n", what, met ? "met" : "MISSED");
  return met;
}

void print_header() {
  fmt::print("\n  {:<34} {:>9} {:>9} {:>9} {:>9} {:>9}\n", "time per tick, µs", "p50", "p99", "p99.9", "p99.99", "max");
}

void print_row(const char* what, const Percentiles& p) {
  fmt::print("  {:<34} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f} {:>9.2f}\n", what, p.p50, p.p99, p.p999, p.p9999, p.max);
}

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

void draw(const std::string& script, const std::string& picture) {
  std::fflush(stdout);
  std::FILE* gnuplot = popen("gnuplot", "w");
  if (gnuplot) fmt::print(gnuplot, "{}", script);
  if (!gnuplot || pclose(gnuplot) != 0) fmt::print("  no picture: gnuplot failed; install gnuplot-nox\n");
  else fmt::print("  picture:    {}\n", picture);
}

}  // namespace controller
