// Prints the table of docs/exactness.md: where ok ends as robots near a singular M.
#include <fmt/format.h>

#include <cstring>

#include "status_measured.hpp"

namespace {

using namespace dalembert::status_family;

std::string cell(const Way& way) { return way.ok ? fmt::format("{:.1f}", way.digits) : fmt::format("no: {}", way.coordinate); }

// Ways of v̇ or of M⁻¹ that compute in double and tell a coordinate.
template <class F>
void each_way(const Measured& measured, const F& f) {
  for (const Way& way : measured.ways)
    if (way.name.find("generic") == std::string::npos) f(way);
}

void one_shape(const std::string& name) {
  for (const Shape& shape : shapes()) {
    if (shape.name != name) continue;
    std::string head = "| distance | condition |", rule = "|---|---:|";
    each_way(measure(shape, 1, 1), [&](const Way& way) { head += fmt::format(" {} |", way.name), rule += "---:|"; });
    fmt::print("{}\n{}\n", head, rule);
    for (int exponent = 3; exponent <= 16; ++exponent) {
      const Measured measured = measure(shape, std::pow(10, -exponent), 1);
      std::string row = fmt::format("| 1e-{} | {} |", exponent,
                                    measured.condition < 1e16 ? fmt::format("{:.0e}", measured.condition) : "> 1e16");
      each_way(measured, [&](const Way& way) { row += " " + cell(way) + " |"; });
      fmt::print("{}\n", row);
    }
  }
}

void all_shapes() {
  fmt::print(
      "| robot | v̇ ok up to | digits | v̇ not ok from | M⁻¹ ok up to | digits | M⁻¹ not ok from "
      "|\n|---|---:|---:|---:|---:|---:|---:|\n");
  for (const Shape& shape : shapes()) {
    double largest[2] = {0, 0}, digits[2] = {99, 99}, least[2] = {1e99, 1e99};  // of v̇ and of M⁻¹
    for (int step = 0; step <= 64; ++step)
      for (unsigned seed = 1; seed <= (shape.before + shape.behind > 12 ? 4u : 2u); ++seed) {
        const Measured measured = measure(shape, std::pow(10, -0.25 * step), seed);
        each_way(measured, [&](const Way& way) {
          const int what = way.name[0] == 'M';
          if (way.ok)
            largest[what] = std::max(largest[what], measured.condition), digits[what] = std::min(digits[what], way.digits);
          if (!way.ok) least[what] = std::min(least[what], measured.condition);
        });
      }
    fmt::print("| {} |", shape.name);
    for (const int what : {0, 1})
      fmt::print(" {} | {} | {} |", largest[what] > 0 ? fmt::format("{:.0e}", largest[what]) : "none",
                 largest[what] > 0 ? fmt::format("{:.1f}", digits[what]) : "",
                 least[what] < 1e99 ? fmt::format("{:.0e}", least[what]) : "none");
    fmt::print("\n");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count == 3 && std::strcmp(arguments[1], "--shape") == 0) {
    one_shape(arguments[2]);
  } else if (count == 1) {
    one_shape("parallel_3");
    fmt::print("\n");
    all_shapes();
  } else {
    fmt::print(stderr, "usage: status_family [--shape NAME]\n");
    return 2;
  }
}
