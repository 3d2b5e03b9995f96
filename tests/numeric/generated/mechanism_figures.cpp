// What docs/mechanisms.md says of mechanisms with loops in figures, as its tables; exit status 1 where one is worse than the
// page promises.
//
//   mechanism_figures           the tables
//   mechanism_figures --quick   three seconds of motion instead of ten, and without times
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <ctime>
#include <dalembert/constraints.hpp>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/quaternion_joint.hpp>
#include <functional>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "commands/machine.hpp"
#include "commands/timing.hpp"
#include "ir/loop_length.hpp"
#include "pipeline.hpp"
#include "reference/engine.hpp"

// Generated code as an object: everything else is compiled once for all.
struct Code {
  const char* name;
  std::vector<dalembert::QuaternionJoint> quaternions;

  virtual ~Code() = default;
  // v̇, which stays until the next call, and what became of the rows.
  virtual const double* forward(const double* q, const double* v, const double* tau) = 0;
  virtual dalembert::ConstraintStatus<double> status() const = 0;
  virtual double energy(const double* q, const double* v) = 0;
  virtual void set(bool active, double kp, double kd) = 0;

 protected:
  template <class Joints>
  Code(const char* of_name, const Joints& joints) : name(of_name), quaternions(std::begin(joints), std::end(joints)) {}
  template <class Workspace>
  static double sum(const Workspace& workspace) {
    if constexpr (requires { workspace.potential_energy; }) return workspace.kinetic_energy[0] + workspace.potential_energy[0];
    else return workspace.kinetic_energy[0];
  }
};

// What code without quaternions in its joints does not say.
static constexpr std::array<dalembert::QuaternionJoint, 0> quaternion_joints{};

#define MECHANISM_CODE(space, ...)                                                                                       \
  namespace space {                                                                                                      \
  struct Code final : ::Code {                                                                                           \
    Code() : ::Code(#space, quaternion_joints) {}                                                                        \
    const double* forward(const double* q, const double* v, const double* tau) override {                                \
      space::forward_dynamics(q, v, tau, workspace);                                                                     \
      return workspace.constrained_forward_dynamics;                                                                     \
    }                                                                                                                    \
    dalembert::ConstraintStatus<double> status() const override { return workspace.forward_dynamics_constraint_status; } \
    double energy(const double* q, const double* v) override {                                                           \
      space::evaluate(q, v, workspace);                                                                                  \
      return sum(workspace);                                                                                             \
    }                                                                                                                    \
    void set(bool active, double kp, double kd) override {                                                               \
      for (auto* loop : {__VA_ARGS__}) loop->active = active, loop->kp = kp, loop->kd = kd;                              \
    }                                                                                                                    \
    Workspace workspace;                                                                                                 \
  };                                                                                                                     \
  }
#include "mechanism_codes.hpp"

namespace dalembert::testing {
namespace {

bool quick = false;

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
std::string short_number(double x) { return x == 0 ? "0" : std::isinf(x) ? "apart" : fmt::format("{:.0e}", x); }

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

double largest(const Matrix& m) { return m.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }

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

class Mechanism {
 public:
  using Efforts = std::function<Vector(const Vector&, const Vector&)>;
  using Energy = std::function<double(const Vector&)>;

  // Joints at zero and at rest, until `start` says otherwise.
  explicit Mechanism(std::unique_ptr<Code> code, Efforts efforts = {}, Energy more = {})
      : model(read(code->name)),
        quaternion_joints(code->quaternions),
        start{Vector::Zero(model.tree.nq()), Vector::Zero(model.tree.nv())},
        code_(std::move(code)),
        efforts_(std::move(efforts)),
        more_(std::move(more)) {
    for (const QuaternionJoint& joint : quaternion_joints) start.q[joint.q + (joint.slides ? 6 : 3)] = 1;
    if (model.tree.base_coordinates() > 0) start.q[6] = 1;
  }

  struct At {
    Vector q, v;
  };
  const Model model;
  const std::vector<QuaternionJoint> quaternion_joints;  // as the integrator asks for them
  At start, now;
  bool active = true;  // of its loops

  Vector acceleration(const Vector& q, const Vector& v) {
    const Vector v_dot = Eigen::Map<const Vector>(code_->forward(q.data(), v.data(), efforts(q, v).data()), v.size());
    const ConstraintStatus<double> status = code_->status();
    kept_.most_rank = std::max(kept_.most_rank, status.rank);
    kept_.least_pivot = std::min(kept_.least_pivot, status.least_pivot);
    return v_dot;
  }

  // From the start to where it is now. States along the way are kept of the first run with gains.
  Kept run(double seconds, double step, double kp, double kd) {
    code_->set(active, kp, kd);
    kept_ = {};
    now = start;
    const double before = energy();
    const int steps = static_cast<int>(std::lround(seconds / step)), looks = std::max(steps / (quick ? 100 : 500), 1);
    for (int i = 1; i <= steps; ++i) {
      integrators::rk4(*this, step, now.q, now.v);
      if (i % looks != 0) continue;
      kept_.energy = std::max(kept_.energy, std::abs(energy() - before));
      kept_.gap = std::max(kept_.gap, gap());
      if (std::isnan(kept_.energy + kept_.gap) || !now.q.allFinite()) {
        kept_.energy = kept_.gap = INFINITY;
        break;
      }
      if (kp > 0 && i % (looks * 10) == 0 && states_.size() < (quick ? 10 : 50)) states_.push_back(now);
    }
    code_->set(active, 0, 0);
    return kept_;
  }

  // Of the state that it is in.
  double energy() {
    const double sum = code_->energy(now.q.data(), now.v.data());
    return more_ ? sum + more_(now.q) : sum;
  }

  // In double, but for errors: what the reference makes of it now.
  Matrix reference_of(ir::Quantity quantity) const {
    return reference::evaluate(model.tree, model.scene, {{quantity, ""}}, {now.q, now.v}, reference::Precision::float64)
        .front();
  }

  // The start's velocities become the nearest that the loops allow.
  void allow() {
    now = start;
    const Matrix J = reference_of(ir::Quantity::constraint_jacobian);
    start.v -= J.completeOrthogonalDecomposition().solve(J * start.v);
  }

  // How far the loops' rows are from closed, m and rad.
  double gap() const {
    double most = 0;
    std::vector<reference::Wanted> wanted;
    for (const ir::Loop& loop : model.scene.loops)
      for (const std::string& link : loop.links) wanted.push_back({std::nullopt, link, ir::LinkQuantity::pose});
    const std::vector<Matrix> found =
        reference::evaluate(model.tree, model.scene, wanted, {now.q, now.v}, reference::Precision::float64);
    for (std::size_t l = 0; l < model.scene.loops.size(); ++l) {
      const ir::Loop& loop = model.scene.loops[l];
      Eigen::Isometry3d poses[2] = {Eigen::Isometry3d::Identity(), Eigen::Isometry3d::Identity()};
      for (std::size_t i = 0; i < 2; ++i) {
        poses[i].matrix().topRows<3>() = found[2 * l + i];
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

  // The largest error of v̇ over the states that were kept, of its largest element, against 50 digits: of the code, and of the
  // same equations as they are written, in double.
  std::pair<double, double> errors() {
    double code = 0, as_written = 0;
    const std::vector<reference::Wanted> wanted{{ir::Quantity::constrained_forward_dynamics, ""}};
    for (const At& at : states_) {
      const reference::Inputs inputs{at.q, at.v, efforts(at.q, at.v)};
      const auto in = [&](reference::Precision precision) {
        return reference::evaluate(model.tree, model.scene, wanted, inputs, precision).front();
      };
      const Matrix exact = in(reference::Precision::digits_50);
      const double scale = std::max(largest(exact), reference::LeastScale(model.tree, model.scene, inputs).of(wanted.front()));
      code = std::max(code, largest(acceleration(at.q, at.v) - exact) / scale);
      as_written = std::max(as_written, largest(in(reference::Precision::float64)-exact) / scale);
    }
    return {code, as_written};
  }

  CallTime time() {
    std::vector<Vector> efforts_at;
    for (const At& at : states_) efforts_at.push_back(efforts(at.q, at.v));
    return time_calls(states_.size(),
                      [&](std::size_t i) { code_->forward(states_[i].q.data(), states_[i].v.data(), efforts_at[i].data()); });
  }

 private:
  Vector efforts(const Vector& q, const Vector& v) const { return efforts_ ? efforts_(q, v) : Vector(Vector::Zero(v.size())); }

  std::unique_ptr<Code> code_;
  const Efforts efforts_;
  const Energy more_;
  Kept kept_;
  std::vector<At> states_;
};

std::vector<std::vector<std::string>> drifts, calls;

void show(const char* title, Mechanism& mechanism, Run run) {
  if (quick) run.seconds = std::min(run.seconds, 3.0);
  const Kept loose = mechanism.run(run.seconds, run.step, 0, 0), held = mechanism.run(run.seconds, run.step, run.kp, run.kd);
  demand(held.energy < run.most_energy && held.gap < run.most_gap,
         fmt::format("{}: with gains it keeps its energy to {} J and its loops to {} m", title, held.energy, held.gap));
  drifts.push_back({title, fmt::format("{:g} s, {:g} µs", run.seconds, run.step * 1e6), short_number(loose.gap),
                    short_number(loose.energy), fmt::format("{:g}, {:g}", run.kp, run.kd), short_number(held.gap),
                    short_number(held.energy)});
  const auto [error, as_written] = mechanism.errors();
  demand(error < run.most_error, fmt::format("{}: an error of {}", title, error));
  calls.push_back({title, fmt::format("{}", mechanism.model.tree.nv()),
                   fmt::format("{}", mechanism.model.scene.constraint_rows()), fmt::format("{}", held.most_rank),
                   short_number(held.least_pivot), quick ? "–" : time_text(mechanism.time().median), short_number(error),
                   short_number(as_written)});
}

Eigen::Vector2d turned(double angle, double x, double y) {
  return {std::cos(angle) * x - std::sin(angle) * y, std::sin(angle) * x + std::cos(angle) * y};
}

// Coordinates β Θ γ δ Φ ε Ω. What the file cannot say: the motor, and the spring from a point of k3 to C.
Mechanism squeezer(double motor) {
  const auto along = [](double gamma) -> Eigen::Vector2d {
    return turned(gamma, 20e-3, -18e-3) + Eigen::Vector2d(-0.03635 - 0.014, 0.03273 - 0.072);
  };
  Mechanism robot(
      std::make_unique<andrews::Code>(),
      [=](const Vector& q, const Vector&) {
        Vector tau = Vector::Zero(7);
        tau[0] = motor;
        const Eigen::Vector2d arm = turned(q[2], 20e-3, -18e-3), d = along(q[2]), force = -4530 * (1 - 0.07785 / d.norm()) * d;
        tau[2] = arm[0] * force[1] - arm[1] * force[0];
        return tau;
      },
      [=](const Vector& q) {
        const double stretch = along(q[2]).norm() - 0.07785;
        return 4530 * stretch * stretch / 2 - motor * q[0];
      });
  robot.start.q << -0.0617138900142764496, 0, 0.455279819163070380, 0.487364979543842550, 0.222668390165885885,
      1.23054744454982120, -0.222668390165885885;
  return robot;
}

void show_squeezer(std::vector<std::vector<std::string>>& reached) {
  Mechanism driven = squeezer(0.033);
  Vector end(7);  // at 0.03 s (IVP test set)
  end << 15.81077119629904, -15.75637105984298, 0.04082224013073101, 0.5244099658805304, -0.5347301163226948, 1.048080741042263,
      0.5347301163226948;
  driven.run(0, 1, 0, 0);
  const Vector a = driven.acceleration(driven.start.q, driven.start.v);
  reached.push_back({"Andrews' squeezer", "β̈ at the start, rad/s²", "14222.4439199541", fmt::format("{:.10f}", a[0])});
  reached.push_back({"", "Θ̈ at the start, rad/s²", "−10666.8329399656", fmt::format("−{:.10f}", -a[1])});
  demand(std::abs(a[0] - 14222.4439199541) < 2e-6 && std::abs(a[1] + 10666.8329399656) < 2e-6, "the squeezer begins otherwise");
  driven.run(0.03, 1e-5, 0, 0);
  const char* names[] = {"β", "Θ", "γ", "δ", "Φ", "ε", "Ω"};
  for (int i = 0; i < 7; ++i)
    reached.push_back({"", fmt::format("{} at 0.03 s, rad", names[i]), fmt::format("{:.13f}", end[i]),
                       fmt::format("{:.13f}", driven.now.q[i])});
  demand(largest(driven.now.q - end) < 2e-8, "the squeezer ends otherwise");
  show("Andrews' squeezer, motor", driven,
       {.seconds = 0.03, .step = 1e-5, .kp = 1e6, .kd = 2e3, .most_energy = 1e-7, .most_gap = 1e-8});
  Mechanism free = squeezer(0);
  free.start.v[0] = 10;  // it begins where its spring is at rest
  free.allow();
  show("Andrews' squeezer, spring alone", free,
       {.seconds = 10, .step = 2.5e-5, .kp = 1e6, .kd = 2e3, .most_energy = 1e-5, .most_gap = 1e-6});
}

void show_bricard(std::vector<std::vector<std::string>>& reached) {
  Mechanism rods(std::make_unique<bricard::Code>());
  rods.run(0, 1, 0, 0);
  reached.push_back({"Bricard's mechanism", "energy at the start, J", "−29.43", fmt::format("−{:.13f}", -rods.energy())});
  rods.run(10, 1e-3, 0, 0);
  reached.push_back({"", "energy after 10 s, J", "−29.43", fmt::format("−{:.13f}", -rods.energy())});
  show("Bricard's mechanism", rods, {.most_energy = 1e-3});
}

void show_four_bars(std::vector<std::vector<std::string>>& reached) {
  const auto of = [&](const char* title, std::unique_ptr<Code> code, double most_energy) {
    Mechanism bars(std::move(code));  // an upright and what lies across it in turn, at 1 m/s
    for (Eigen::Index i = 0; i < bars.start.v.size(); ++i) bars.start.v[i] = i % 2 == 0 ? -1 : 1;
    bars.run(0, 1, 0, 0);
    const double before = bars.energy();
    show(title, bars, {.most_energy = most_energy});
    reached.push_back(
        {title, "energy after the run with gains, J", fmt::format("{:.10f}", before), fmt::format("{:.10f}", bars.energy())});
  };
  of("Two four-bars", std::make_unique<four_bars::Code>(), 1e-6);
  of("Forty four-bars", std::make_unique<four_bars_40::Code>(), 1e-3);
}

void show_slider_crank() {
  const double crank = 0.3, rod = -std::asin(0.2 / 0.5 * std::sin(crank)), rate = 1.7,
               rod_rate = -0.2 * std::cos(crank) / (0.5 * std::cos(rod)) * rate;
  Mechanism robot(std::make_unique<slider_crank::Code>());
  robot.start.q << crank, rod - crank, 0.2 * std::cos(crank) + 0.5 * std::cos(rod);
  robot.start.v << rate, rod_rate - rate, -0.2 * std::sin(crank) * rate - 0.5 * std::sin(rod) * rod_rate;
  show("Slider-crank", robot, {});
}

// Couplers of 0.5 m that are rigid, then springs and dampers of the benchmark's.
void show_governor(std::vector<std::vector<std::string>>& reached) {
  constexpr int shaft = governor::v_index(governor::Joint::shaft_joint),
                slider = governor::v_index(governor::Joint::slider_joint),
                left = governor::v_index(governor::Joint::rod_left_joint),
                right = governor::v_index(governor::Joint::rod_right_joint);
  const auto begin = [](Mechanism& robot) {
    robot.start.q[slider] = 0.5;
    robot.start.q[left] = robot.start.q[right] = std::numbers::pi / 6;
    robot.start.v[shaft] = 2 * std::numbers::pi;
  };
  const auto momentum = [](const Mechanism& robot) {
    return robot.reference_of(ir::Quantity::mass_matrix).row(shaft).dot(robot.now.v);
  };
  Mechanism rigid(std::make_unique<governor::Code>());
  begin(rigid);
  show("Governor, rigid couplers", rigid, {});
  Mechanism stiff(std::make_unique<governor::Code>(), [](const Vector& at, const Vector& rate) {
    Vector tau = Vector::Zero(4);
    for (const int rod : {left, right}) {
      const double x = 0.5 * std::cos(at[rod]), z = 1 - 0.5 * std::sin(at[rod]) - at[slider], length = std::hypot(x, z),
                   by_rod = (x * -0.5 * std::sin(at[rod]) - z * 0.5 * std::cos(at[rod])) / length, by_slider = -z / length,
                   force = -8e5 * (length - 0.5) - 4e4 * (by_rod * rate[rod] + by_slider * rate[slider]);
      tau[rod] = by_rod * force;
      tau[slider] += by_slider * force;
    }
    return tau;
  });
  begin(stiff);
  stiff.active = false;
  stiff.run(0, 1, 0, 0);
  const double turning = momentum(stiff);
  for (const double seconds : {1.0, 10.0}) {
    if (quick && seconds > 1) break;
    stiff.run(seconds, 2.5e-5, 0, 0);
    const double halved = stiff.now.q[slider];
    stiff.run(seconds, 5e-5, 0, 0);
    rigid.run(seconds, 1e-3, 400, 40);
    reached.push_back({seconds == 1 ? "Stiff governor" : "",
                       fmt::format("slider after {} s, m: with half the step; steps of 50 µs", seconds),
                       fmt::format("{:.12f}", halved), fmt::format("{:.12f}", stiff.now.q[slider])});
    reached.push_back({"", "the same with rigid couplers", "", fmt::format("{:.12f}", rigid.now.q[slider])});
    demand(std::abs(halved - stiff.now.q[slider]) < 1e-8,
           fmt::format("the stiff governor is at {} or {}", halved, stiff.now.q[slider]));
  }
  reached.push_back({"", "its angular momentum about the shaft, kg m²/s", fmt::format("{:.12f}", turning),
                     fmt::format("{:.12f}", momentum(stiff))});
  demand(std::abs(turning - momentum(stiff)) < 1e-8, "the governor does not keep its angular momentum");
}

// What is moved by nothing but springs and weight, from zero at some speed.
void show_sprung(const char* title, std::unique_ptr<Code> code) {
  Mechanism robot(std::move(code));
  for (int i = 0; i < robot.start.v.size(); ++i) robot.start.v[i] = 0.3 * std::sin(1 + 2 * i);
  robot.allow();
  show(title, robot, {});
}

int figures() {
  std::vector<std::vector<std::string>> reached;
  show_squeezer(reached);
  show_bricard(reached);
  show_four_bars(reached);
  show_slider_crank();
  show_governor(reached);
  show_sprung("Stewart platform", std::make_unique<stewart::Code>());
  show_sprung("Delta robot", std::make_unique<delta::Code>());
  show_sprung("Legs with four-bars, in flight", std::make_unique<legs::Code>());
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
