// How accurate generated code is: its largest error over many random states, in ulp of the largest exact element.
//
//   accuracy [--states N] [--limit ULP] [--robot NAME]...      all robots but the chains and trees, 10000 states, 32 ulp
//
// Exact: the generic engine in 100 decimal digits on the same doubles, rounded. One row per robot, base, library and
// quantity; the libraries are those of M, C, g and bias that benchmark_peers times (-O3 -march=native). `over`: states beyond
// the limit. `generic max`: the generic engine in double on the same states, which shows where a state is hard for any program:
// an arm that balances has a g whose largest element is what remains of much larger terms. Exit status 1 when an error exceeds
// the limit or a result is not finite, 2 for bad usage.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <dalembert/generic/dynamics.hpp>
#include <iterator>
#include <limits>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "benchmark_robots.hpp"
#include "generated_robot.hpp"
#include "generated_table.hpp"
#include "load_robot.hpp"
#include "reference/generic_model.hpp"

namespace dalembert::benchmarks {
namespace {

struct Options {
  int states = 10000;
  double limit = 32;
  std::vector<std::string> robots;
};

constexpr ir::Quantity measured_quantities[] = {ir::Quantity::mass_matrix, ir::Quantity::coriolis_matrix, ir::Quantity::gravity,
                                                ir::Quantity::bias};

bool is_measured(const GeneratedRobot& library) {
  const auto known = [](const GeneratedOutput& output) {
    return !output.values || std::count(std::begin(measured_quantities), std::end(measured_quantities), output.quantity);
  };
  return std::all_of(library.results.begin(), library.results.end(), known);
}

// Errors of one library, one vector per quantity among its outputs.
using Errors = std::map<ir::Quantity, std::vector<double>>;

void append(Errors& errors, const Results& ours, const Results& exact) {
  for (const auto& [quantity, result] : ours) errors[quantity].push_back(ulp_error(result, exact.at(quantity)));
}

// States first, first + step, ... up to the count: errors of each library, then of the generic engine.
void measure(const ir::KinematicTree& tree, const std::vector<const GeneratedRobot*>& libraries, int first, int step, int count,
             std::vector<Errors>& errors) {
  std::vector<GeneratedEvaluation> evaluations;
  for (const GeneratedRobot* library : libraries) evaluations.emplace_back(*library);
  errors.resize(libraries.size() + 1);
  const Eigen::Vector3d gravity(0, 0, -9.81);
  const generic::Model<double> model = to_generic<double>(tree, gravity);
  for (int i = first; i < count; i += step) {
    const testing::State state = testing::moderate_state(tree, static_cast<std::uint64_t>(i + 1));
    const Results exact = exact_results(tree, gravity, state);
    for (size_t k = 0; k < libraries.size(); ++k) {
      evaluations[k].run(state);
      append(errors[k], evaluations[k].results(tree), exact);
    }
    append(errors.back(), generic_results(model, state), exact);
  }
}

// Prints the rows of one robot with one base. Returns whether all are within the limit.
bool report(const RobotEntry& entry, bool floating, const std::vector<const GeneratedRobot*>& libraries,
            const Options& options) {
  const ir::KinematicTree tree = testing::load_robot({entry.name, entry.urdf}, floating);
  const int workers = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::vector<Errors>> parts(static_cast<size_t>(workers));
  std::vector<std::thread> threads;
  for (int w = 0; w < workers; ++w) {
    threads.emplace_back([&, w] { measure(tree, libraries, w, workers, options.states, parts[static_cast<size_t>(w)]); });
  }
  for (std::thread& thread : threads) thread.join();

  const auto sorted = [&](size_t library, ir::Quantity quantity) {
    std::vector<double> all;
    for (auto& part : parts) all.insert(all.end(), part[library][quantity].begin(), part[library][quantity].end());
    std::sort(all.begin(), all.end());
    return all;
  };
  bool good = true;
  for (size_t k = 0; k < libraries.size(); ++k) {
    for (const ir::Quantity quantity : measured_quantities) {
      const std::vector<double> all = sorted(k, quantity);
      if (all.empty()) continue;
      const auto over = all.end() - std::upper_bound(all.begin(), all.end(), options.limit);
      good = good && over == 0;
      std::printf("%-10s %-9s %-9s %-16s %8d %10.2f %10.2f %6d %12.2f\n", entry.name, floating ? "floating" : "fixed",
                  libraries[k]->outputs, ir::row_of(quantity).name, static_cast<int>(all.size()), all.back(),
                  all[all.size() / 2], static_cast<int>(over), sorted(libraries.size(), quantity).back());
    }
  }
  std::fflush(stdout);
  return good;
}

bool wanted(const RobotEntry& entry, const Options& options) {
  const std::string name = entry.name;
  if (options.robots.empty()) return name.rfind("chain_", 0) != 0 && name.rfind("tree_", 0) != 0;
  return std::find(options.robots.begin(), options.robots.end(), name) != options.robots.end();
}

int run(const Options& options) {
  std::printf("%-10s %-9s %-9s %-16s %8s %10s %10s %6s %12s\n", "robot", "base", "library", "quantity", "states", "max ulp",
              "median ulp", "over", "generic max");
  bool good = true, any = false;
  for (const RobotEntry& entry : benchmark_robots) {
    if (!wanted(entry, options)) continue;
    std::map<bool, std::vector<const GeneratedRobot*>> by_base;
    for (const GeneratedRobot& library : generated_robots) {
      if (std::string(library.robot) != entry.name || !is_measured(library)) continue;
      const std::string outputs = library.outputs;
      by_base[outputs == "floating" || (outputs != "fixed" && entry.floating)].push_back(&library);
    }
    for (const auto& [floating, libraries] : by_base) {
      good = report(entry, floating, libraries, options) && good;
      any = true;
    }
  }
  if (!any) {
    std::fprintf(stderr, "accuracy: no such robot\n");
    return 2;
  }
  return good ? 0 : 1;
}

}  // namespace
}  // namespace dalembert::benchmarks

int main(int argc, char** argv) {
  dalembert::benchmarks::Options options;
  for (int i = 1; i < argc; i += 2) {
    const std::string option = argv[i];
    const char* value = i + 1 < argc ? argv[i + 1] : "";
    if (option == "--states" && std::atoi(value) > 0) {
      options.states = std::atoi(value);
    } else if (option == "--limit" && std::atof(value) > 0) {
      options.limit = std::atof(value);
    } else if (option == "--robot" && *value) {
      options.robots.push_back(value);
    } else {
      std::fprintf(stderr, "usage: accuracy [--states N] [--limit ULP] [--robot NAME]...\n");
      return 2;
    }
  }
  return dalembert::benchmarks::run(options);
}
