// What docs/mechanisms.md says of mechanisms with loops in figures, as its tables; exit status 1 where one is worse than the
// page promises.
//
//   mechanism_figures           the tables
//   mechanism_figures --quick   without times
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/quaternion_joint.hpp>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "commands/machine.hpp"
#include "commands/timing.hpp"
#include "ir/loop_length.hpp"
#include "pipeline.hpp"
#include "reference/engine.hpp"

// What code without quaternions in its joints does not say.
static constexpr std::array<dalembert::QuaternionJoint, 0> quaternion_joints{};

// The generated code of one namespace as a type.
#define MECHANISM_CODE(space, ...)                                                                      \
  namespace space {                                                                                     \
  struct Code {                                                                                         \
    static constexpr const char* name = #space;                                                         \
    static constexpr auto& quaternions = quaternion_joints;                                             \
    using VectorQ = space::VectorQ;                                                                     \
    using VectorV = space::VectorV;                                                                     \
    using Workspace = space::Workspace;                                                                 \
    static void forward(const VectorQ& q, const VectorV& v, const VectorV& tau, Workspace& workspace) { \
      space::forward_dynamics(q.data(), v.data(), tau.data(), workspace);                               \
    }                                                                                                   \
    static void evaluate(const VectorQ& q, const VectorV& v, Workspace& workspace) {                    \
      space::evaluate(q.data(), v.data(), workspace);                                                   \
    }                                                                                                   \
    template <class Visit>                                                                              \
    static void visit_loops(Workspace& workspace, const Visit& visit) {                                 \
      for (auto* loop : {__VA_ARGS__}) visit(*loop);                                                    \
    }                                                                                                   \
  };                                                                                                    \
  }
#include "mechanism_codes.hpp"

namespace dalembert::testing {
namespace {

bool all_kept = true;
void demand(bool kept, const std::string& what) {
  if (kept) return;
  all_kept = false;
  fmt::print(stderr, "mechanism_figures: {}\n", what);
}

void print_row(const std::vector<std::string>& cells) { fmt::print("| {} |\n", fmt::join(cells, " | ")); }
void print_header(std::vector<std::string> cells) {
  print_row(cells);
  for (std::string& cell : cells) cell = "---:";
  cells[0] = "---";
  print_row(cells);
}
std::string short_number(double x) { return x == 0 ? "0" : fmt::format("{:.0e}", x); }

double largest(const Eigen::MatrixXd& m) { return m.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }

Model read(const std::string& name) {
  Request request;
  request.robot = fmt::format("{}/{}.urdf", MECHANISMS, name);
  request.scene_file = fmt::format("{}/{}.yaml", MECHANISMS, name);
  Diagnostics warnings;
  return read_model(request, warnings);
}

// What happens in a run, and what a mechanism is asked to keep.
struct Run {
  double seconds = 10, step = 1e-3;
  double kp = 400, kd = 40;                                        // of the run that is stabilised
  double most_energy = 1e-5, most_gap = 1e-6, most_error = 1e-11;  // with gains
};

// What came of one.
struct Kept {
  double energy = 0, gap = 0;
  int most_rank = 0;
  double least_pivot = 1;
};

template <class Code>
class Mechanism {
 public:
  using VectorQ = typename Code::VectorQ;
  using VectorV = typename Code::VectorV;
  using Workspace = typename Code::Workspace;
  using Efforts = std::function<VectorV(const VectorQ&, const VectorV&)>;
  using Energy = std::function<double(const VectorQ&)>;

  Mechanism(VectorQ start, VectorV speed, Efforts efforts = {}, Energy more = {})
      : model(read(Code::name)),
        q_(std::move(start)),
        v_(std::move(speed)),
        efforts_(std::move(efforts)),
        more_(std::move(more)) {}

  static constexpr auto& quaternion_joints = Code::quaternions;  // as the integrator asks for them
  const Model model;

  // As the integrator asks for it.
  VectorV acceleration(const VectorQ& q, const VectorV& v) {
    Code::forward(q, v, efforts(q, v), workspace_);
    kept_.most_rank = std::max(kept_.most_rank, workspace_.forward_dynamics_constraint_status.rank);
    kept_.least_pivot = std::min(kept_.least_pivot, workspace_.forward_dynamics_constraint_status.least_pivot);
    return Eigen::Map<const VectorV>(workspace_.constrained_forward_dynamics);
  }

  void release() {
    Code::visit_loops(workspace_, [](auto& loop) { loop.active = false; });
  }

  // From the start; q and v are where it ends. States along the way are kept of the first run with gains.
  Kept run(double seconds, double step, double kp, double kd) {
    Code::visit_loops(workspace_, [&](auto& loop) { loop.kp = kp, loop.kd = kd; });
    kept_ = {};
    q = q_;
    v = v_;
    const double before = energy();
    const int steps = static_cast<int>(std::lround(seconds / step)), looks = std::max(steps / 1000, 1);
    for (int i = 1; i <= steps; ++i) {
      integrators::rk4(*this, step, q, v);
      if (i % looks != 0) continue;
      kept_.energy = std::max(kept_.energy, std::abs(energy() - before));
      kept_.gap = std::max(kept_.gap, gap());
      if (std::isnan(kept_.energy + kept_.gap) || !q.allFinite()) {
        kept_.energy = kept_.gap = INFINITY;
        break;
      }
      if (kp > 0 && i % (looks * 20) == 0 && states_.size() < 50) states_.push_back({q, v});
    }
    Code::visit_loops(workspace_, [&](auto& loop) { loop.kp = loop.kd = 0; });
    return kept_;
  }

  double energy() {
    Code::evaluate(q, v, workspace_);
    double sum = workspace_.kinetic_energy[0];
    if constexpr (requires { workspace_.potential_energy; }) sum += workspace_.potential_energy[0];
    return more_ ? sum + more_(q) : sum;
  }

  // How far the loops' rows are from closed, m and rad.
  double gap() const {
    double most = 0;
    for (const ir::Loop& loop : model.scene.loops) {
      Eigen::Isometry3d poses[2];
      for (int i = 0; i < 2; ++i) {
        const Eigen::MatrixXd pose =
            reference::evaluate(model.tree, model.scene, {{std::nullopt, loop.links[i], ir::LinkQuantity::pose}}, {q, v},
                                reference::Precision::float64)
                .front();
        poses[i] = Eigen::Isometry3d::Identity();
        poses[i].matrix().topRows(3) = pose;
        poses[i] = poses[i] * loop.at[i];
      }
      const Eigen::Vector3d between = poses[1].translation() - poses[0].translation();
      if (loop.type == ir::LoopType::distance) {
        most = std::max(most, std::abs(between.norm() - ir::loop_length(model.tree, loop)));
        continue;
      }
      const Eigen::Vector3d along = poses[0].linear().transpose() * between,
                            turned = poses[0].linear().col(2).cross(poses[1].linear().col(2));
      for (const int i : loop.linear_axes()) most = std::max(most, std::abs(along[i]));
      if (!loop.angular_axes().empty()) most = std::max(most, turned.norm());
    }
    return most;
  }

  int rows() const { return model.scene.constraint_rows(); }

  // The largest error of v̇ over the states that were kept, of its largest element, against 50 digits: of the code, and of the
  // same equations as they are written, in double.
  std::pair<double, double> errors() {
    double code = 0, as_written = 0;
    const std::vector<reference::Wanted> wanted{{ir::Quantity::constrained_forward_dynamics, ""}};
    for (const auto& [at, rate] : states_) {
      const VectorV tau = efforts(at, rate), ours = acceleration(at, rate);
      const auto in = [&](reference::Precision precision) {
        return reference::evaluate(model.tree, model.scene, wanted, {at, rate, tau}, precision).front();
      };
      const Eigen::MatrixXd exact = in(reference::Precision::digits_50);
      code = std::max(code, largest(ours - exact) / largest(exact));
      as_written = std::max(as_written, largest(in(reference::Precision::float64)-exact) / largest(exact));
    }
    return {code, as_written};
  }

  CallTime time() {
    std::vector<VectorV> efforts_at;
    for (const auto& [at, rate] : states_) efforts_at.push_back(efforts(at, rate));
    return time_calls(states_.size(),
                      [&](std::size_t i) { Code::forward(states_[i].first, states_[i].second, efforts_at[i], workspace_); });
  }

  VectorQ q = VectorQ::Zero();
  VectorV v = VectorV::Zero();

 private:
  VectorV efforts(const VectorQ& at, const VectorV& rate) const {
    return efforts_ ? efforts_(at, rate) : VectorV(VectorV::Zero());
  }

  const VectorQ q_;
  const VectorV v_;
  const Efforts efforts_;
  const Energy more_;
  Workspace workspace_;
  Kept kept_;
  std::vector<std::pair<VectorQ, VectorV>> states_;
};

// All joints at zero.
template <class Code>
typename Code::VectorQ at_rest() {
  typename Code::VectorQ q = Code::VectorQ::Zero();
  for (const QuaternionJoint& joint : Code::quaternions) q[joint.q + (joint.slides ? 6 : 3)] = 1;
  if (static_cast<std::size_t>(q.size() - Code::VectorV::RowsAtCompileTime) > std::size(Code::quaternions))
    q[6] = 1;  // the base's
  return q;
}

// The nearest velocities that the loops allow.
template <class Code>
typename Code::VectorV allowed(const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  const Model model = read(Code::name);
  const Eigen::MatrixXd J = reference::evaluate(model.tree, model.scene, {{ir::Quantity::constraint_jacobian, ""}}, {q, v},
                                                reference::Precision::extended)
                                .front();
  return v - J.completeOrthogonalDecomposition().solve(J * v);
}
template <class Code>
typename Code::VectorV some_velocity(const Eigen::VectorXd& q) {
  typename Code::VectorV v;
  for (int i = 0; i < v.size(); ++i) v[i] = 0.3 * std::sin(1 + 2 * i);
  return allowed<Code>(q, v);
}

bool quick = false;
std::vector<std::vector<std::string>> drifts, calls;

template <class Code>
void show(const char* title, Mechanism<Code>& mechanism, const Run& run) {
  const Kept loose = mechanism.run(run.seconds, run.step, 0, 0), held = mechanism.run(run.seconds, run.step, run.kp, run.kd);
  demand(held.energy < run.most_energy && held.gap < run.most_gap,
         fmt::format("{}: with gains it keeps its energy to {} J and its loops to {} m", title, held.energy, held.gap));
  drifts.push_back({title, fmt::format("{:g} s, {:g} µs", run.seconds, run.step * 1e6), short_number(loose.gap),
                    short_number(loose.energy), fmt::format("{:g}, {:g}", run.kp, run.kd), short_number(held.gap),
                    short_number(held.energy)});
  const auto [error, as_written] = mechanism.errors();
  demand(error < run.most_error, fmt::format("{}: an error of {}", title, error));
  calls.push_back({title, fmt::format("{}", mechanism.model.tree.nv()), fmt::format("{}", mechanism.rows()),
                   fmt::format("{}", held.most_rank), short_number(held.least_pivot),
                   quick ? "–" : time_text(mechanism.time().median), short_number(error), short_number(as_written)});
}

Eigen::Vector2d turned(double angle, double x, double y) {
  return {std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y};
}

// Coordinates β Θ γ δ Φ ε Ω. What the file cannot say: the motor, and the spring from a point of k3 to C.
Mechanism<andrews::Code> squeezer(double motor) {
  andrews::VectorQ q;
  q << -0.0617138900142764496, 0, 0.455279819163070380, 0.487364979543842550, 0.222668390165885885, 1.23054744454982120,
      -0.222668390165885885;
  const auto along = [](double gamma) -> Eigen::Vector2d {
    return turned(gamma, 20e-3, -18e-3) + Eigen::Vector2d(-0.03635 - 0.014, 0.03273 - 0.072);
  };
  return {q, andrews::VectorV::Zero(),
          [=](const andrews::VectorQ& at, const andrews::VectorV&) {
            andrews::VectorV tau = andrews::VectorV::Zero();
            tau[0] = motor;
            const Eigen::Vector2d arm = turned(at[2], 20e-3, -18e-3), d = along(at[2]),
                                  force = -4530 * (1 - 0.07785 / d.norm()) * d;
            tau[2] = arm[0] * force[1] - arm[1] * force[0];
            return tau;
          },
          [=](const andrews::VectorQ& at) {
            const double stretch = along(at[2]).norm() - 0.07785;
            return 4530 * stretch * stretch / 2 - motor * at[0];
          }};
}

void show_squeezer(std::vector<std::vector<std::string>>& reached) {
  auto driven = squeezer(0.033);
  andrews::VectorQ end;  // at 0.03 s (IVP test set)
  end << 15.81077119629904, -15.75637105984298, 0.04082224013073101, 0.5244099658805304, -0.5347301163226948, 1.048080741042263,
      0.5347301163226948;
  driven.run(0, 1, 0, 0);
  const andrews::VectorV a = driven.acceleration(driven.q, driven.v);
  reached.push_back({"Andrews' squeezer", "β̈ at the start, rad/s²", "14222.4439199541", fmt::format("{:.10f}", a[0])});
  reached.push_back({"", "Θ̈ at the start, rad/s²", "−10666.8329399656", fmt::format("−{:.10f}", -a[1])});
  demand(std::abs(a[0] - 14222.4439199541) < 2e-6 && std::abs(a[1] + 10666.8329399656) < 2e-6, "the squeezer begins otherwise");
  driven.run(0.03, 1e-5, 0, 0);
  const char* names[] = {"β", "Θ", "γ", "δ", "Φ", "ε", "Ω"};
  for (int i = 0; i < 7; ++i)
    reached.push_back(
        {"", fmt::format("{} at 0.03 s, rad", names[i]), fmt::format("{:.13f}", end[i]), fmt::format("{:.13f}", driven.q[i])});
  demand(largest(driven.q - end) < 2e-8, "the squeezer ends otherwise");
  show("Andrews' squeezer, motor", driven,
       {.seconds = 0.03, .step = 1e-5, .kp = 1e6, .kd = 2e3, .most_energy = 1e-7, .most_gap = 1e-8});
  auto free = squeezer(0);
  show("Andrews' squeezer, spring alone", free,
       {.seconds = 10, .step = 2.5e-5, .kp = 1e6, .kd = 2e3, .most_energy = 1e-5, .most_gap = 1e-6});
}

void show_bricard(std::vector<std::vector<std::string>>& reached) {
  Mechanism<bricard::Code> rods(bricard::VectorQ::Zero(), bricard::VectorV::Zero());
  rods.run(0, 1, 0, 0);
  reached.push_back({"Bricard's mechanism", "energy at the start, J", "−29.43", fmt::format("−{:.13f}", -rods.energy())});
  rods.run(10, 1e-3, 0, 0);
  reached.push_back({"", "energy after 10 s, J", "−29.43", fmt::format("−{:.13f}", -rods.energy())});
  show("Bricard's mechanism", rods, {.most_energy = 1e-3, .most_error = 1e-7});
}

void show_four_bars(std::vector<std::vector<std::string>>& reached) {
  four_bars::VectorV v;
  v << -1, 1, -1, 1, -1;
  Mechanism<four_bars::Code> bars(four_bars::VectorQ::Zero(), v);
  bars.run(0, 1, 0, 0);
  const double before = bars.energy();
  bars.run(10, 1e-3, 400, 40);
  reached.push_back(
      {"Two four-bars", "energy after 10 s, J", fmt::format("{:.13f}", before), fmt::format("{:.13f}", bars.energy())});
  show("Two four-bars", bars, {});
}

void show_slider_crank() {
  const double crank = 0.3, rod = -std::asin(0.2 / 0.5 * std::sin(crank)), rate = 1.7,
               rod_rate = -0.2 * std::cos(crank) / (0.5 * std::cos(rod)) * rate;
  Mechanism<slider_crank::Code> robot(
      slider_crank::VectorQ(crank, rod - crank, 0.2 * std::cos(crank) + 0.5 * std::cos(rod)),
      slider_crank::VectorV(rate, rod_rate - rate, -0.2 * std::sin(crank) * rate - 0.5 * std::sin(rod) * rod_rate));
  show("Slider-crank", robot, {});
}

// Forty: as two, the first joint of each upright and across in turn.
void show_forty(std::vector<std::vector<std::string>>& reached) {
  four_bars_40::VectorV v;
  for (int i = 0; i < 81; ++i) v[i] = i % 2 == 0 ? -1 : 1;
  Mechanism<four_bars_40::Code> bars(four_bars_40::VectorQ::Zero(), v);
  bars.run(0, 1, 0, 0);
  const double before = bars.energy();
  bars.run(10, 1e-3, 400, 40);
  reached.push_back(
      {"Forty four-bars", "energy after 10 s, J", fmt::format("{:.10f}", before), fmt::format("{:.10f}", bars.energy())});
  show("Forty four-bars", bars, {.most_energy = 1e-4});
}

// Couplers of 0.5 m that are rigid, then springs and dampers of the benchmark's.
void show_governor(std::vector<std::vector<std::string>>& reached) {
  using Q = governor::VectorQ;
  using V = governor::VectorV;
  constexpr int shaft = governor::v_index(governor::Joint::shaft_joint),
                slider = governor::v_index(governor::Joint::slider_joint),
                left = governor::v_index(governor::Joint::rod_left_joint),
                right = governor::v_index(governor::Joint::rod_right_joint);
  Q q = Q::Zero();
  V v = V::Zero();
  q[slider] = 0.5;
  q[left] = q[right] = std::numbers::pi / 6;
  v[shaft] = 2 * std::numbers::pi;
  const auto momentum = [](const auto& robot) {
    const Eigen::MatrixXd M = reference::evaluate(robot.model.tree, robot.model.scene, {{ir::Quantity::mass_matrix, ""}},
                                                  {robot.q, robot.v}, reference::Precision::float64)
                                  .front();
    return M.row(shaft).dot(robot.v);
  };
  Mechanism<governor::Code> rigid(q, v);
  show("Governor, rigid couplers", rigid, {});
  Mechanism<governor::Code> stiff(q, v, [](const Q& at, const V& rate) {
    V tau = V::Zero();
    for (const int rod : {left, right}) {
      const double x = 0.5 * std::cos(at[rod]), z = 1 - 0.5 * std::sin(at[rod]) - at[slider], length = std::hypot(x, z),
                   by_rod = (x * -0.5 * std::sin(at[rod]) - z * 0.5 * std::cos(at[rod])) / length, by_slider = -z / length,
                   force = -8e5 * (length - 0.5) - 4e4 * (by_rod * rate[rod] + by_slider * rate[slider]);
      tau[rod] = by_rod * force;
      tau[slider] += by_slider * force;
    }
    return tau;
  });
  stiff.release();
  stiff.run(0, 1, 0, 0);
  const double turning = momentum(stiff);
  for (const double seconds : {1.0, 10.0}) {
    stiff.run(seconds, 2.5e-5, 0, 0);
    const double halved = stiff.q[slider];
    stiff.run(seconds, 5e-5, 0, 0);
    rigid.run(seconds, 1e-3, 400, 40);
    reached.push_back({seconds == 1 ? "Stiff governor" : "",
                       fmt::format("slider after {} s, m: with half the step; steps of 50 µs", seconds),
                       fmt::format("{:.12f}", halved), fmt::format("{:.12f}", stiff.q[slider])});
    reached.push_back({"", "the same with rigid couplers", "", fmt::format("{:.12f}", rigid.q[slider])});
    demand(std::abs(halved - stiff.q[slider]) < 1e-8,
           fmt::format("the stiff governor is at {} or {}", halved, stiff.q[slider]));
  }
  reached.push_back({"", "its angular momentum about the shaft, kg m²/s", fmt::format("{:.12f}", turning),
                     fmt::format("{:.12f}", momentum(stiff))});
  demand(std::abs(turning - momentum(stiff)) < 1e-8, "the governor does not keep its angular momentum");
}

// What is moved by nothing but springs and weight, from rest at zero, at some speed.
template <class Code>
void show_sprung(const char* title, const Run& run) {
  const auto q = at_rest<Code>();
  Mechanism<Code> robot(q, some_velocity<Code>(q));
  show(title, robot, run);
}

int figures() {
  std::vector<std::vector<std::string>> reached;
  show_squeezer(reached);
  show_bricard(reached);
  show_four_bars(reached);
  show_forty(reached);
  show_slider_crank();
  show_governor(reached);
  show_sprung<stewart::Code>("Stewart platform", {});
  show_sprung<delta::Code>("Delta robot", {});
  show_sprung<legs::Code>("Legs with four-bars, in flight", {});
  const std::time_t now = std::time(nullptr);
  char date[16];
  std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
  fmt::print("{}, {}\n\n", this_machine().text(), date);
  print_header({"mechanism", "what", "is to be", "is"});
  for (const auto& row : reached) print_row(row);
  fmt::print("\n");
  print_header({"mechanism", "run, step", "gap, no gains", "energy, no gains, J", "kp, kd", "gap", "energy, J"});
  for (const auto& row : drifts) print_row(row);
  fmt::print("\n");
  print_header({"mechanism", "nv", "rows", "rank", "least pivot", "time", "error", "as written"});
  for (const auto& row : calls) print_row(row);
  return all_kept ? 0 : 1;
}

}  // namespace
}  // namespace dalembert::testing

int main(int argc, char** argv) {
  dalembert::testing::quick = argc > 1 && std::strcmp(argv[1], "--quick") == 0;
  return dalembert::testing::figures();
}
