// Writes the part of docs/performance.md between "<!-- scenes -->" and "<!-- /scenes -->": operations, time, bytes and error of
// each scene example, measured here and now.
//
// Times are processor times of one thread, so that others on the machine count as little as possible: the median of many short
// batches, the examples taking turns, with the distance between the quartiles as spread.
#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "code_size.hpp"
#include "commands/machine.hpp"
#include "costs.hpp"
#include "scene_examples.hpp"

namespace dalembert::scenes {
namespace {

constexpr int rounds = 60;

double processor_ns() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e9 * static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec);
}

// ns per evaluation in one batch.
double batch(const Example& e, const std::vector<State>& states, void* workspace) {
  constexpr int calls = 2000;
  const double start = processor_ns();
  for (int i = 0; i < calls; ++i) {
    const State& state = states[static_cast<size_t>(i) % states.size()];
    e.evaluate(state.q.data(), state.v.data(), workspace);
  }
  return (processor_ns() - start) / calls;
}

double quantile(std::vector<double> values, double at) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(at * static_cast<double>(values.size() - 1))];
}

std::string with_spread(const std::vector<double>& values, const char* format) {
  const double median = quantile(values, 0.5), spread = (quantile(values, 0.75) - quantile(values, 0.25)) / median;
  return fmt::format("{} ± {:.0f}%", fmt::format(fmt::runtime(format), median), 100 * spread);
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d", std::localtime(&now));
  return text;
}

std::string operations(const ir::Operations& o) { return fmt::format("{} + {}", o.total(), o.sincos); }

using Times = std::map<std::string, std::vector<double>>;  // per example, round by round

const std::vector<State>& states_of(const Example& e) {
  static std::map<std::string, std::vector<State>> states;
  const auto [at, made] = states.try_emplace(e.name);
  if (made) at->second = random_states(e.model.tree, 20);
  return at->second;
}

Times measure() {
  Times times;
  std::map<std::string, std::shared_ptr<void>> workspaces;
  for (const Example& e : examples()) workspaces[e.name] = e.workspace();
  for (int round = -3; round < rounds; ++round)  // the first to warm up
    for (const Example& e : examples()) {
      const double time = batch(e, states_of(e), workspaces[e.name].get());
      if (round >= 0) times[e.name].push_back(time);
    }
  return times;
}

std::string page() {
  double load[1] = {0};
  if (getloadavg(load, 1) < 1) load[0] = 0;
  const Times times = measure();
  std::string text = fmt::format(
      "## What scenes save\n\n"
      "Written by `cmake --build build/release --target scenes_page` on {}: {}, one thread, load average {:.1f} before the\n"
      "measurement (0 on an idle machine); {}.\n\n"
      "The scenes are those of [examples/scenes](../examples/scenes), in the order of their cost. *Operations* are additions,\n"
      "multiplications and divisions + pairs of sine and cosine; *before* is the URDF without a scene, as the equations are\n"
      "written (see [scene.md](scene.md#what-was-left-out)). *Time* is processor time per evaluation, the median of {}\n"
      "batches of 2000 evaluations, the scenes taking turns; ± is the distance between the quartiles. *Code* is machine code\n"
      "+ constants, without the C API. *Error* is the largest difference to the generic engine on the reduced model at 20\n"
      "random states, relative to the result's largest element.\n\n"
      "| Scene | nv | Operations before | here | Time, ns | Code, bytes | Workspace, bytes | Error |\n"
      "|---|---|---|---|---|---|---|---|\n",
      today(), this_machine().text(), load[0], COMPILER, rounds);
  for (const Example& e : examples()) {
    const std::vector<OperationCost> before = costs_before(e.model);
    const benchmarks::CodeSize size = benchmarks::code_size(e.archive);
    text += fmt::format("| `{}`: {} | {} | {} | {} | {} | {} + {} | {} | {:.1e} |\n", e.name, e.meaning, e.model.tree.nv(),
                        before.empty() ? "" : operations(before.front().operations),
                        operations(operation_costs(e.model).front().operations), with_spread(times.at(e.name), "{:.0f}"),
                        size.text, size.tables, e.workspace_bytes, error_of(e, states_of(e)));
  }
  std::vector<double> ratios;
  for (int i = 0; i < rounds; ++i)
    ratios.push_back(100 * times.at("legs_only")[static_cast<size_t>(i)] /
                     times.at("full_mass_coriolis")[static_cast<size_t>(i)]);
  return text + fmt::format(
                    "\nThe legs alone, waist and arms locked, take {} of the full robot's time for M and C (paired, round\n"
                    "by round).\n",
                    with_spread(ratios, "{:.0f} %"));
}

}  // namespace
}  // namespace dalembert::scenes

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: measure_scenes PAGE.md\n", stderr);
    return 2;
  }
  std::ifstream old(argv[1], std::ios::binary);
  std::string page(std::istreambuf_iterator<char>(old), {});
  const std::string from = "<!-- scenes -->\n", to = "<!-- /scenes -->";
  const size_t begin = page.find(from), end = page.find(to);
  if (begin == page.npos || end == page.npos) {
    std::fprintf(stderr, "measure_scenes: %s has no place between %s and %s\n", argv[1], "<!-- scenes -->", to.c_str());
    return 2;
  }
  const std::string text = dalembert::scenes::page();
  page.replace(begin + from.size(), end - begin - from.size(), text);
  std::ofstream file(argv[1], std::ios::binary);
  file << page;
  file.close();
  if (!file) {
    std::fprintf(stderr, "measure_scenes: cannot write %s\n", argv[1]);
    return 2;
  }
  std::fputs(text.c_str(), stdout);
  return 0;
}
