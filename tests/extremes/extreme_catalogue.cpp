// The catalogue as the table of docs/exactness.md.
//
//   extreme_catalogue [--states N] [--slow] [--robot NAME]
//
// 30 states unless told otherwise; --slow: chains of hundreds of joints, too, which take minutes; --robot: no other than this
// one.
//
// Exit status 1 when a robot does not keep its promise, 2 for bad usage.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "extremes.hpp"

int main(int argc, char** argv) {
  using namespace dalembert::extremes;
  int states = 30;
  bool slow = false;
  std::string only;
  for (int i = 1; i < argc; ++i) {
    if (!std::strcmp(argv[i], "--slow")) slow = true;
    else if (!std::strcmp(argv[i], "--states") && i + 1 < argc && std::atoi(argv[i + 1]) > 0) states = std::atoi(argv[++i]);
    else if (!std::strcmp(argv[i], "--robot") && i + 1 < argc) only = argv[++i];
    else return std::fprintf(stderr, "usage: extreme_catalogue [--states N] [--slow] [--robot NAME]\n"), 2;
  }
  std::printf("| robot | what it is | M | C | g | bias | M | C | g | bias | condition | v̇ | v̇ | promised | met |\n");
  std::printf("|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---|\n");
  bool good = true;
  for (const Robot& robot : robots()) {
    if (only.empty() ? robot.slow && !slow : robot.name != only) continue;
    const Figures figures = measure(robot, robot.slow ? 2 : states, "-O3 -march=native -std=c++17");
    bool kept = figures.finite && (robot.normalised == 0 || figures.normalised[0] <= robot.normalised);
    std::printf("| %s | %s |", robot.name.c_str(), robot.what.c_str());
    for (double ulp : figures.ulp) {
      std::printf(" %.2g |", ulp);
      kept = kept && ulp <= robot.ulp;
    }
    for (double ulp : figures.normalised) std::printf(" %.2g |", ulp);
    kept = kept && figures.forward <= 1;
    std::printf(" %.1e | %.2g%s | %.2g | %g%s%s | %s |\n", figures.condition, figures.forward,
                figures.reported ? ", reported" : "", figures.forward_normalised, robot.ulp, robot.why.empty() ? "" : ": ",
                robot.why.c_str(), kept ? "yes" : "NO");
    std::fflush(stdout);
    good = good && kept;
  }
  return good ? 0 : 1;
}
