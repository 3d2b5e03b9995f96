// What docs/integrators.md says of the integrators in figures, as its tables; exit status 1 where one does not keep what the
// page promises.
//
//   integrator_figures            the tables
//   integrator_figures --quick    ten seconds of motion instead of sixty
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "load_robot.hpp"
#include "reference/trajectory.hpp"
#include "states.hpp"
#include "systems.hpp"
#include "trend.hpp"

namespace dalembert::testing {
namespace {

bool all_kept = true;
void demand(bool kept, const std::string& what) {
  if (kept) return;
  all_kept = false;
  fmt::print(stderr, "integrator_figures: {}\n", what);
}

template <class Code>
struct Method {
  using S = System<Code>;
  const char* name;
  bool (*step)(S&, double, typename S::VectorQ&, typename S::VectorV&);  // false: it gives up
};

template <class Code>
constexpr Method<Code> methods[] = {
    {"semi-implicit Euler",
     [](auto& s, double h, auto& q, auto& v) { return integrators::semi_implicit_euler(s, h, q, v), true; }},
    {"RK4", [](auto& s, double h, auto& q, auto& v) { return integrators::rk4(s, h, q, v), true; }},
    {"implicit midpoint", [](auto& s, double h, auto& q, auto& v) { return integrators::implicit_midpoint(s, h, q, v); }},
    {"linearly implicit", [](auto& s, double h, auto& q, auto& v) { return integrators::linearly_implicit(s, h, q, v), true; }},
};
enum { euler, rk4, midpoint, linear };

const ir::KinematicTree& tree_of(const char* name, bool floating) {
  for (const TestRobot& robot : test_robots)
    if (std::string(robot.name) == name) {
      static std::vector<std::unique_ptr<ir::KinematicTree>> trees;
      trees.push_back(std::make_unique<ir::KinematicTree>(load_robot(robot, floating)));
      return *trees.back();
    }
  throw std::runtime_error(fmt::format("no robot {}", name));
}

void print_row(const std::vector<std::string>& cells) { fmt::print("| {} |\n", fmt::join(cells, " | ")); }
void print_header(std::vector<std::string> cells) {
  print_row(cells);
  for (std::string& cell : cells) cell = "---:";
  cells[0] = "---";
  print_row(cells);
}

// MAHRU in free flight, the same spring and damper in every joint, joints moving a little.
struct Stiff {
  using S = System<FreeMahru>;
  S system;
  S::VectorQ q = S::VectorQ::Zero();
  S::VectorV v = S::VectorV::Constant(0.1);

  Stiff(double stiffness, double damping) {
    system.stiffness.tail<25>().setConstant(stiffness);
    system.damping.tail<25>().setConstant(damping);
    q[6] = 1;
    for (int i = 0; i < 25; ++i) q[7 + i] = 1e-4 * std::sin(1 + i);
  }
};

// Whether the energy stays below twice what it was: 500 steps.
bool is_stable(const Method<FreeMahru>& method, double stiffness, double damping, double h) {
  Stiff stiff(stiffness, damping);
  const double before = stiff.system.energy(stiff.q, stiff.v);
  for (int i = 0; i < 500; ++i) {
    if (!method.step(stiff.system, h, stiff.q, stiff.v)) return false;
    if (!stiff.v.allFinite() || stiff.v.cwiseAbs().maxCoeff() > 1e6) return false;
  }
  return stiff.system.energy(stiff.q, stiff.v) <= 2 * before;
}

// Of 10 ms, 5, 2, 1 and so on; in seconds; none: 0.
double largest_stable_step(const Method<FreeMahru>& method, double stiffness, double damping) {
  for (double decade = 1e-2; decade > 1e-13; decade /= 10)
    for (const double part : {1.0, 0.5, 0.2})
      if (is_stable(method, stiffness, damping, part * decade)) return part * decade;
  return 0;
}

void print_largest_steps(const char* what, bool springs) {
  std::vector<std::string> header{what};
  for (const auto& method : methods<FreeMahru>) header.emplace_back(method.name);
  print_header(header);
  for (double size : {1.0, 1e3, 1e5, 1e6, 1e9}) {
    std::vector<std::string> row{fmt::format("{:.0e}", size)};
    for (const auto& method : methods<FreeMahru>) {
      const double step = springs ? largest_stable_step(method, size, 0) : largest_stable_step(method, 1, size);
      row.push_back(step == 0 ? "none" : fmt::format("{:g} ms", step * 1e3));
      if (&method == &methods<FreeMahru>[linear])
        demand(step == 1e-2, fmt::format("linearly implicit needs {} s at {}", step, size));
      if (&method == &methods<FreeMahru>[rk4] && size == 1e9) demand(step < 1e-3, "RK4 bears 1e9 at 1 ms");
    }
    print_row(row);
  }
  fmt::print("\n");
}

// Springs and dampers together, every step: how many of the 36 combinations stay bounded.
void print_combinations() {
  std::vector<std::string> header{"step"};
  for (const auto& method : methods<FreeMahru>) header.emplace_back(method.name);
  print_header(header);
  for (double h : {1e-4, 1e-3, 1e-2}) {
    std::vector<std::string> row{fmt::format("{:g} ms", h * 1e3)};
    for (const auto& method : methods<FreeMahru>) {
      int bounded = 0, all = 0;
      for (double stiffness : {1.0, 1e2, 1e4, 1e6, 1e8, 1e9})
        for (double damping : {0.0, 1.0, 1e2, 1e4, 1e6, 1e9}) ++all, bounded += is_stable(method, stiffness, damping, h);
      row.push_back(fmt::format("{} of {}", bounded, all));
      if (&method == &methods<FreeMahru>[linear])
        demand(bounded == all, fmt::format("linearly implicit bears {} of {}", bounded, all));
    }
    print_row(row);
  }
  fmt::print("\n");
}

// Energies of a motion without springs or dampers, kept every 20 ms, J.
template <class Code>
std::vector<double> energies(const Method<Code>& method, double h, double seconds, typename System<Code>::VectorQ q,
                             typename System<Code>::VectorV v,
                             const std::function<double(const reference::Motion&)>& potential) {
  System<Code> system;
  std::vector<double> list;
  const long steps = std::lround(seconds / h), every = std::lround(0.02 / h);
  for (long i = 0; i <= steps; ++i) {
    if (i % every == 0) list.push_back(system.energy(q, v) + potential({q, v}));
    if (!method.step(system, h, q, v) || !v.allFinite()) return {};
  }
  return list;
}

template <class Code>
void print_energies(const char* what, double seconds, const typename System<Code>::VectorQ& q,
                    const typename System<Code>::VectorV& v, const std::function<double(const reference::Motion&)>& potential,
                    double kinetic_scale, bool chaotic) {
  const double steps[] = {1e-2, 5e-3, 2.5e-3, 1.25e-3};
  std::vector<std::string> header{what};
  for (double h : steps) header.push_back(fmt::format("{:g} ms", h * 1e3));
  header.emplace_back("order");
  print_header(header);
  for (const Method<Code>& method : methods<Code>) {
    std::vector<std::string> row{method.name};
    std::vector<double> errors;
    for (double h : steps) {
      const std::vector<double> curve = energies<Code>(method, h, seconds, q, v, potential);
      if (curve.empty()) {
        row.push_back("diverges");
        continue;
      }
      double worst = 0;
      for (double e : curve) worst = std::max(worst, std::abs(e - curve.front()));
      errors.push_back(worst / kinetic_scale);
      row.push_back(fmt::format("{:.1e}", errors.back()));
    }
    const double order = errors.size() > 1 ? std::log2(errors[errors.size() - 2] / errors.back()) : NAN;
    row.push_back(fmt::format("{:.1f}", order));
    print_row(row);
    // Where the motion is chaotic, the worst error of one step size is of another motion than that of the next.
    if (&method == &methods<Code>[midpoint])
      demand(std::abs(order - 2) < (chaotic ? 0.8 : 0.3), fmt::format("{}: midpoint's order is {}", what, order));
    if (&method == &methods<Code>[rk4]) demand(order > 3.7, fmt::format("{}: RK4's order is {}", what, order));
  }
  fmt::print("\n");
}

// Of two pendulums that swing without chaos: what their energy gains in a minute, over its oscillation.
void print_drifts() {
  using S = System<TwoPendulums>;
  const S::VectorQ q(std::numbers::pi / 2 + 0.5, 0.3);
  const auto workspace = std::make_unique<two_pendulums::Workspace>();
  const auto potential = [&](const reference::Motion& at) {
    demand(two_pendulums::evaluate(at.q, at.v, *workspace), "two pendulums: a state of another length");
    return two_pendulums::potential_energy(*workspace)(0);
  };
  const double steps[] = {1e-2, 5e-3, 2.5e-3};
  std::vector<std::string> header{"two pendulums, drift over oscillation"};
  for (double h : steps) header.push_back(fmt::format("{:g} ms", h * 1e3));
  print_header(header);
  for (const int number : {rk4, midpoint}) {  // those of first order come to rest or take off
    const Method<TwoPendulums>& method = methods<TwoPendulums>[number];
    std::vector<std::string> row{method.name};
    for (double h : steps) {
      const std::vector<double> curve = energies<TwoPendulums>(method, h, 60, q, S::VectorV::Zero(), potential);
      const auto [least, most] = std::minmax_element(curve.begin(), curve.end());
      const double drift = trend(curve) / (*most - *least);
      row.push_back(fmt::format("{:.1g} %", 100 * drift));
      if (number == midpoint)
        demand(std::abs(drift) < 0.01, fmt::format("midpoint drifts by {} of its oscillation in a minute", drift));
    }
    print_row(row);
  }
  fmt::print("\n");
}

// Of MAHRU in free flight, over ten seconds.
void print_momentum() {
  using S = System<FreeMahru>;
  const State start = moderate_state(tree_of("mahru", true), 7);
  const double steps[] = {2e-3, 1e-3, 5e-4};
  std::vector<std::string> header{"momentum, 10 s"};
  for (double h : steps) header.push_back(fmt::format("{:g} ms", h * 1e3));
  print_header(header);
  double best = 1;
  for (const auto& method : methods<FreeMahru>) {
    std::vector<std::string> row{method.name};
    for (double h : steps) {
      S system;
      S::VectorQ q = start.q;
      S::VectorV v = start.v;
      const Eigen::Matrix<double, 6, 1> before = system.momentum(q, v);
      bool good = true;
      for (long i = 0; good && i < std::lround(10 / h); ++i) good = method.step(system, h, q, v) && v.allFinite();
      const double off = (system.momentum(q, v) - before).norm() / before.norm();
      row.push_back(good ? fmt::format("{:.1e}", off) : "diverges");
      if (good) best = std::min(best, off);
    }
    print_row(row);
  }
  demand(best < 1e-9, fmt::format("the best momentum is off by {}", best));
}

// MAHRU in free flight, its left elbow pressed against a stop that a 1 kHz loop renders as a torque held from tick to tick:
// a spring of the angle read, or of the angle that M says the elbow will have at the next tick.
class Wall {
 public:
  Wall(double stiffness, double damping, bool ahead) : stiffness_(stiffness), ahead_(ahead) {
    system_.damping[base + elbow] = damping;
    q_[6] = 1;
  }

  // Whether the elbow, let go at the wall, comes to rest rather than shakes more and more: its fastest in the last quarter of a
  // second, against the first.
  bool holds() {
    double first = 0, last = 0;
    for (int tick = 0; tick < 1000; ++tick) {
      system_.effort[base + elbow] = pressing + torque();
      for (int i = 0; i < substeps; ++i) integrators::rk4(system_, period / substeps, q_, v_);
      const double speed = std::abs(v_[base + elbow]);
      if (!v_.allFinite() || speed > 1e3) return false;
      if (tick < 250) first = std::max(first, speed);
      if (tick >= 750) last = std::max(last, speed);
    }
    return last < first;
  }

 private:
  using S = System<FreeMahru>;
  static constexpr int base = 6, base_positions = 7, elbow = static_cast<int>(free_mahru::Joint::left_elbow), substeps = 4;
  static constexpr double period = 1e-3, pressing = -2;  // s, N m

  double torque() {
    const double angle = q_[base_positions + elbow];
    if (!ahead_) return std::max(0.0, -stiffness_ * angle);
    system_.effort[base + elbow] = pressing;
    const S::VectorV free = system_.acceleration(q_, v_);
    system_.effort[base + elbow] = pressing + 1;
    const double per_torque = system_.acceleration(q_, v_)[base + elbow] - free[base + elbow];  // of M^-1
    const double next = angle + period * v_[base + elbow] + period * period * free[base + elbow];
    return std::max(0.0, -stiffness_ * next / (1 + period * period * stiffness_ * per_torque));
  }

  S system_;
  S::VectorQ q_ = S::VectorQ::Zero();
  S::VectorV v_ = S::VectorV::Zero();
  double stiffness_;
  bool ahead_;
};

// Of 10, 20, 50, 100, … up to the first that does not hold; none: 0.
double stiffest_wall(double damping, bool ahead) {
  double stiffest = 0;
  for (double decade = 10; decade < 5e9; decade *= 10)
    for (const double part : {1.0, 2.0, 5.0}) {
      if (part * decade > 1e9) return stiffest;
      if (!Wall(part * decade, damping, ahead).holds()) return stiffest;
      stiffest = part * decade;
    }
  return stiffest;
}

void print_walls() {
  print_header({"dampers, N m s/rad", "2 b / T", "spring of the angle read", "of the next angle by M"});
  for (const double damping : {0.01, 0.1, 1.0, 10.0}) {
    const double read = stiffest_wall(damping, false), next = stiffest_wall(damping, true);
    print_row({fmt::format("{:g}", damping), fmt::format("{:g}", 2 * damping / 1e-3),
               read == 0 ? "none" : fmt::format("{:g}", read), next == 0 ? "none" : fmt::format("{:g}", next)});
    demand(next == 1e9, fmt::format("the wall one tick ahead holds up to {} at {}", next, damping));
    demand(read < 1e6, fmt::format("the wall of the angle read holds up to {} at {}", read, damping));
  }
  fmt::print("\n");
}

int run(bool quick) {
  const double seconds = quick ? 10 : 60;
  print_largest_steps("springs, N m/rad", true);
  print_largest_steps("dampers, N m s/rad", false);
  print_combinations();
  print_walls();
  {
    using S = System<PendulumChain>;
    const ir::KinematicTree& tree = tree_of("planar_chain_10", false);
    const ir::Scene scene;
    S::VectorQ q = 0.2 * moderate_state(tree, 7).q / 3;
    q[0] += std::numbers::pi / 2;  // links lie along x and hang so
    const auto potential = [&](const reference::Motion& at) { return reference::potential_energy(tree, scene, at); };
    S::VectorQ hanging = S::VectorQ::Zero();
    hanging[0] = std::numbers::pi / 2;
    const S::VectorV v = S::VectorV::Zero();
    print_energies<PendulumChain>(fmt::format("ten pendulums, {:g} s", seconds).c_str(), seconds, q, v, potential,
                                  potential({q, v}) - potential({hanging, v}), false);
  }
  {
    using S = System<FreeMahru>;
    const State start = moderate_state(tree_of("mahru", true), 7);
    const S::VectorQ q = start.q;
    const S::VectorV v = 0.2 * start.v;
    S system;
    print_energies<FreeMahru>(
        fmt::format("MAHRU in free flight, {:g} s", seconds).c_str(), seconds, q, v,
        [](const reference::Motion&) { return 0.0; }, system.energy(q, v), true);
  }
  print_drifts();
  print_momentum();
  return all_kept ? 0 : 1;
}

}  // namespace
}  // namespace dalembert::testing

int main(int argc, char** argv) { return dalembert::testing::run(argc > 1 && std::strcmp(argv[1], "--quick") == 0); }
