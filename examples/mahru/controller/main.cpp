// mahru_controller: a 1 kHz torque controller on generated dynamics, against a plant simulated by MuJoCo from the same URDF.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <memory>
#include <stdexcept>

#include "heap_counter.hpp"
#include "loop.hpp"
#include "report.hpp"

namespace {

using namespace controller;

struct Options {
  std::string urdf = MAHRU_URDF;
  Base base = Base::fixed;
  double seconds = 10;
  bool timing_counts = true;
  std::string out = ".";
};

struct WrongDynamics : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Every joint a little beside the reference, so that the feedback has something to do; released, the robot also drifts and
// tumbles.
State start_state(Base base) {
  State state;
  for (int i = 0; i < joints; ++i) state.q[i] = i % 2 ? 0.02 : -0.02;
  if (base == Base::floating) {
    state.base_position = {0, 0, 1};
    state.base_linear = {0.1, -0.05, 0.2};
    state.base_angular = {0.3, 0.5, -0.2};
  }
  return state;
}

// Right on this machine, as it was compiled? Without that no torque is commanded. Returns the time it took, µs.
template <class Law>
double test_dynamics() {
  dalembert::SelfTestReport worst;
  const std::int64_t begun = now();
  const bool right = Law::self_test(&worst);
  const double time = 1e-3 * (now() - begun);
  if (!right) {
    char text[512];
    dalembert::describe(worst, text, sizeof text);
    throw WrongDynamics(text);
  }
  fmt::print("  self-test of the dynamics: passed in {:.0f} µs, largest error {:.2g}, allowed {:.2g}\n", time, worst.error,
             worst.tolerance);
  return time;
}

template <class Law>
bool run(const Options& options) {
  fmt::print("MAHRU, {}: {:g} s at 1 kHz\n", Law::base == Base::fixed ? "pelvis on a stand" : "released without gravity",
             options.seconds);
  const double self_test = test_dynamics<Law>();
  Plant plant(options.urdf, Law::base, Law::joint_names);
  const State start = start_state(Law::base);
  plant.write(start);
  const Reference reference(plant.lower(), plant.upper());
  const auto law = std::make_unique<Law>(start);
  Plant::Account account = plant.make_account();
  std::vector<Tick> ticks(static_cast<std::size_t>(options.seconds / period), Tick{});
  for (const std::string& notice : enter_real_time()) fmt::print("  {}\n", notice);
  std::fflush(stdout);

  const long before = heap_allocations();
  run_loop(*law, plant, reference, account, ticks);
  const long allocated = heap_allocations() - before;

  Summary summary = summarise(ticks, Law::base);
  summary.heap_allocations = allocated;
  summary.self_test = self_test;
  const bool met = print_table(summary, Law::base, Law::joint_names, options.timing_counts);
  write_files(options.out, ticks, Law::base, Law::joint_names);
  return met;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Controls a simulated MAHRU at 1 kHz by the law of Slotine and Li on generated M, C and g.\n"
      "Exit status: 0 all targets met, 1 a target missed, 2 bad input or usage, 3 the dynamics fail their self-test."};
  app.add_option("--base", options.base, "fixed: pelvis on a stand; floating: released without gravity")
      ->transform(CLI::CheckedTransformer(std::map<std::string, Base>{{"fixed", Base::fixed}, {"floating", Base::floating}}));
  app.add_option("--seconds", options.seconds, "length of the run")->check(CLI::Range(1.5, 600.0))->capture_default_str();
  app.add_option("--urdf", options.urdf, "the plant's URDF")->check(CLI::ExistingFile);
  app.add_flag("!--ignore-timing", options.timing_counts,
               "let the exit status rest on the other targets alone: for a machine busy with other work");
  app.add_option("-o,--out", options.out, "folder for the table of all ticks (csv) and the picture (svg)")
      ->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    const bool met = options.base == Base::fixed ? run<FixedBaseLaw>(options) : run<FloatingBaseLaw>(options);
    return met ? 0 : 1;
  } catch (const WrongDynamics& error) {
    fmt::print(stderr, "mahru_controller: refuses to start: the dynamics fail their self-test: {}\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    fmt::print(stderr, "mahru_controller: error: {}\n", error.what());
    return 2;
  }
}
