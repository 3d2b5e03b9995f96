// mahru_standing: MAHRU on its feet. A whole-body law on generated dynamics at 1 kHz, against a plant simulated by MuJoCo from
// the same URDF.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <exception>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "../controller/heap_counter.hpp"
#include "../controller/realtime.hpp"
#include "loop.hpp"
#include "mahru_on_feet/self_test.hpp"
#include "report.hpp"

namespace {

using namespace standing;

constexpr double short_run = 20;  // s, from which on the plan of a minute has room for something

struct Options {
  std::string urdf = MAHRU_URDF;
  bool walk = false;
  int steps = 10;
  double seconds = 60;
  double impulse = 10;
  double friction = 0.7;
  bool timing_counts = true;
  std::string out = ".";
};

struct WrongDynamics : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Right on this machine, as it was compiled? Without that no torque is commanded. Returns the time it took, µs.
double test_dynamics() {
  dalembert::SelfTestReport worst;
  const std::int64_t begun = controller::now();
  const bool right = mahru_on_feet::self_test(&worst);
  const double time = 1e-3 * (controller::now() - begun);
  if (!right) {
    char text[512];
    dalembert::describe(worst, text, sizeof text);
    throw WrongDynamics(text);
  }
  fmt::print("  self-test of the dynamics: passed in {:.0f} µs, largest error {:.2g}, allowed {:.2g}\n", time, worst.error,
             worst.tolerance);
  return time;
}

// Both feet flat on the floor, knees bent, arms hanging.
State start_state() {
  using mahru_on_feet::Joint;
  constexpr double bend = 0.35, thigh_and_shin = 0.6, ankle = 0.1;  // rad, m, m
  State state;
  const auto set = [&](Joint joint, double angle) { state.q[mahru_on_feet::q_index(joint) - 7] = angle; };
  for (const Joint joint : {Joint::left_hip_pitch, Joint::right_hip_pitch, Joint::left_ankle_pitch, Joint::right_ankle_pitch})
    set(joint, -bend);
  for (const Joint joint : {Joint::left_knee, Joint::right_knee}) set(joint, 2 * bend);
  for (const Joint joint : {Joint::left_elbow, Joint::right_elbow}) set(joint, -0.4);
  state.base_position.z() = thigh_and_shin * std::cos(bend) + ankle;
  return state;
}

Plan make_plan(const Options& options, const Law& law) {
  Target start;
  start.com = law.center_of_mass();
  for (const Side side : sides) start.foot[side].p = law.sole_pose(side).col(3);
  if (options.walk) return walk(start, options.steps);
  return options.seconds < short_run ? stand_briefly(start, options.seconds, options.impulse)
                                     : stand(start, options.seconds, options.impulse);
}

bool run(const Options& options) {
  const std::string what = options.walk ? fmt::format("walks {} steps", options.steps) : fmt::format("{:g} s", options.seconds);
  fmt::print("MAHRU on its feet: {} at 1 kHz, floor of friction {:g}\n", what, options.friction);
  const double self_test = test_dynamics();
  Plant plant(options.urdf, mahru_on_feet::joint_names, options.friction);
  const State start = start_state();
  plant.write(start);
  const Beliefs beliefs;
  const auto law = std::make_unique<Law>(start, plant.limits(), beliefs);
  const Plan plan = make_plan(options, *law);
  Plant::Account account = plant.make_account();
  std::vector<Tick> ticks(plan.targets.size());
  for (const std::string& notice : controller::enter_real_time()) fmt::print("  {}\n", notice);
  std::fflush(stdout);

  const long before = controller::heap_allocations();
  const std::size_t done = run_loop(*law, plant.limits(), plant, plan, account, ticks);
  const long allocated = controller::heap_allocations() - before;

  const bool fell = done < ticks.size();
  ticks.resize(done);
  const Limits believed{beliefs.friction, sole_x - beliefs.sole_margin, sole_y - beliefs.sole_margin};
  const Limits there{options.friction, sole_x, sole_y};
  Summary summary = summarise(ticks, plan, believed, there);
  summary.fell = fell;
  summary.self_test = self_test;
  summary.heap_allocations = allocated;
  const bool met = print_tables(summary, plan, options.timing_counts);
  std::filesystem::create_directories(options.out);
  write_files((std::filesystem::path(options.out) / (options.walk ? "mahru_walking" : "mahru_standing")).string(), ticks, plan,
              there);
  return met;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "MAHRU on its feet, simulated by MuJoCo: stands, sways, squats, stands on either foot, is pushed from four sides; or "
      "walks.\n"
      "Exit status: 0 all targets met, 1 a target missed, 2 bad input or usage, 3 the dynamics fail their self-test."};
  app.add_flag("--walk", options.walk, "walk ahead instead");
  app.add_option("--steps", options.steps, "how many steps")->check(CLI::Range(2, 60))->capture_default_str();
  app.add_option("--seconds", options.seconds, "length of the run; below 20 the motions are fewer and quicker")
      ->check(CLI::Range(1.5, 600.0))
      ->capture_default_str();
  app.add_option("--impulse", options.impulse, "of each push at the torso, 0.1 s long, N s")
      ->check(CLI::Range(0.0, 200.0))
      ->capture_default_str();
  app.add_option("--friction", options.friction, "of the floor; the law believes in 0.5 whatever is given here")
      ->check(CLI::Range(0.0, 2.0))
      ->capture_default_str();
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
    return run(options) ? 0 : 1;
  } catch (const WrongDynamics& error) {
    fmt::print(stderr, "mahru_standing: refuses to start: the dynamics fail their self-test: {}\n", error.what());
    return 3;
  } catch (const std::exception& error) {
    fmt::print(stderr, "mahru_standing: error: {}\n", error.what());
    return 2;
  }
}
