// How accurate generated code and the generic engine stay on extreme robots and in extreme states, and how long they take.
//
//   extremes [--states N]      100 states of each case unless told otherwise
//
// Exact: the generic engine in 100 decimal digits on the same doubles. Largest error over the states, in ulp of the largest
// exact element: of the quantity as it is; then with every row, and every column of a matrix, divided by √M_ii, which puts
// joints that move grams beside joints that move tons on one footing (what solving with M needs: M then has a unit
// diagonal). Times are medians of processor time of M, C, g and bias together; the generic engine computes W as well. Exit
// status 1 when a result of generated code is not finite or, as it is, wrong by more than 32 ulp; 2 for bad usage.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <dalembert/generic/dynamics.hpp>
#include <functional>
#include <string>
#include <vector>

#include "benchmark_robots.hpp"
#include "generated_robot.hpp"
#include "load_robot.hpp"
#include "reference/generic_model.hpp"

namespace dalembert::benchmarks {
namespace {

constexpr double limit = 32;
const Eigen::Vector3d gravity(0, 0, -9.81);

// A kind of state: a moderate one, made extreme.
struct Kind {
  const char* name;
  double angles, rates, base;  // factors of joint angles, of all rates and of the base's position
};
constexpr Kind moderate{"moderate", 1, 1, 1};
constexpr Kind state_kinds[] = {moderate,
                                {"angles to 3e5", 1e5, 1, 1},
                                {"angles to 3e9", 1e9, 1, 1},
                                {"rates to 2e3", 1, 1e3, 1},
                                {"rates to 2e-9", 1, 1e-9, 1},
                                {"base 1e9 m off", 1, 1, 1e9}};

testing::State extreme_state(const ir::KinematicTree& tree, const Kind& kind, int seed) {
  testing::State state = testing::moderate_state(tree, static_cast<std::uint64_t>(seed));
  if (tree.base_coordinates() > 0) state.q.head<3>() *= kind.base;
  state.q.tail(tree.independent_joints()) *= kind.angles;
  state.v *= kind.rates;
  return state;
}

// Divided by √M_ii row by row and, for a matrix, column by column.
Results normalised(const Results& results, const Results& exact) {
  const Eigen::VectorXd d = exact.at(ir::Quantity::mass_matrix).diagonal().cwiseSqrt().cwiseInverse();
  Results normalised = results;
  for (auto& [quantity, result] : normalised) {
    result = d.asDiagonal() * result;
    if (ir::row_of(quantity).columns == ir::Extent::nv) result *= d.asDiagonal();
  }
  return normalised;
}

// Largest errors so far: M, C, g, bias as they are, then normalised.
struct Errors {
  std::array<double, 8> ulp{};

  void add(const Results& ours, const Results& exact, size_t first) {
    for (const ir::Quantity quantity :
         {ir::Quantity::mass_matrix, ir::Quantity::coriolis_matrix, ir::Quantity::gravity, ir::Quantity::bias}) {
      double& worst = ulp[first++];
      worst = std::max(worst, ulp_error(ours.at(quantity), exact.at(quantity)));
    }
  }
  void add(const Results& ours, const Results& exact) {
    add(ours, exact, 0);
    add(normalised(ours, exact), normalised(exact, exact), 4);
  }
  double worst() const { return *std::max_element(ulp.begin(), ulp.begin() + 4); }  // as they are
};

// Median over batches of nanoseconds per call; `run` evaluates state i.
double time_per_call(const std::function<void(int)>& run, int states) {
  const auto batch = [&](int rounds) {
    const std::clock_t start = std::clock();
    for (int round = 0; round < rounds; ++round)
      for (int i = 0; i < states; ++i) run(i);
    return static_cast<double>(std::clock() - start) * (1e9 / CLOCKS_PER_SEC) / rounds / states;
  };
  const int rounds = static_cast<int>(std::clamp(5e6 / (batch(1) * states), 1.0, 1e4));
  std::array<double, 9> times;
  for (double& time : times) time = batch(rounds);
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  return times[times.size() / 2];
}

void print_row(const char* robot, const char* kind, const char* engine, const Errors& errors, double nanoseconds) {
  std::printf("%-14s %-15s %-9s", robot, kind, engine);
  for (double ulp : errors.ulp) std::printf(" %8.3g", ulp);
  std::printf(" %10.0f\n", nanoseconds);
}

// Prints the two rows of one case. Returns whether generated code is within the limit.
bool report(const char* robot, const ir::KinematicTree& tree, const GeneratedRobot& library, const Kind& kind, int count) {
  const generic::Model<double> model = to_generic<double>(tree, gravity);
  GeneratedEvaluation evaluation(library);
  std::vector<testing::State> states;
  Errors generated, generic;
  for (int i = 0; i < count; ++i) {
    const testing::State& state = states.emplace_back(extreme_state(tree, kind, i + 1));
    const Results exact = exact_results(tree, gravity, state);
    evaluation.run(state);
    generated.add(evaluation.results(tree), exact);
    generic.add(generic_results(model, state), exact);
  }
  const auto at = [&](int i) -> const testing::State& { return states[static_cast<size_t>(i)]; };
  print_row(robot, kind.name, "generated", generated, time_per_call([&](int i) { evaluation.run(at(i)); }, count));
  print_row(robot, kind.name, "generic", generic, time_per_call([&](int i) { generic_results(model, at(i)); }, count));
  std::fflush(stdout);
  return generated.worst() <= limit;
}

int run(int count) {
  std::printf("%-40s %-35s %-35s\n%-14s %-15s %-9s", "", "ulp, as it is", "ulp, normalised", "robot", "states", "engine");
  for (const char* quantity : {"M", "C", "g", "bias", "M", "C", "g", "bias"}) std::printf(" %8s", quantity);
  std::printf(" %10s\n", "ns");
  bool good = true;
  for (const RobotEntry& entry : extreme_robots) {
    const GeneratedRobot* library = find_generated(entry.name, entry.floating ? "floating" : "fixed");
    const ir::KinematicTree tree = testing::load_robot({entry.name, entry.urdf}, entry.floating);
    for (const Kind& kind : state_kinds) {
      if (entry.chain && &kind != state_kinds) continue;  // an extreme robot in moderate states
      if (kind.base != 1 && !entry.floating) continue;
      good = report(entry.name, tree, *library, kind, count) && good;
    }
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace dalembert::benchmarks

int main(int argc, char** argv) {
  const int states = argc == 1 ? 100 : argc == 3 && std::string(argv[1]) == "--states" ? std::atoi(argv[2]) : 0;
  if (states < 1) {
    std::fprintf(stderr, "usage: extremes [--states N]\n");
    return 2;
  }
  return dalembert::benchmarks::run(states);
}
