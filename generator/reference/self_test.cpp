#include "reference/self_test.hpp"

#include <algorithm>
#include <cmath>
#include <dalembert/self_test.hpp>
#include <limits>
#include <numbers>
#include <random>
#include <set>

#include "ir/emitted_function.hpp"
#include "ir/implicit_joints.hpp"
#include "reference/engine.hpp"
#include "reference/loading.hpp"

namespace dalembert::reference {

namespace {

constexpr int most_states = 3, most_states_of_many_coordinates = 2, many_coordinates = 200;
constexpr Eigen::Index most_elements = 2500;                       // other than zero, compared whole
constexpr Eigen::Index sampled_elements = 1000, most_columns = 8;  // of larger matrices
constexpr long most_pairs = 600;  // of a body and an ancestor: as many as 50 digits are quick for

using Kind = ir::Expectation::Kind;

// Uniform numbers, the same on every system (the distributions of <random> are not).
class Uniform {
 public:
  double operator()(double low, double high) { return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53; }
  double either_sign(double low, double high) { return engine_() & 1 ? (*this)(low, high) : -(*this)(low, high); }

 private:
  std::mt19937_64 engine_{1743};
};

double rounded(double x, ir::ScalarType scalar) { return scalar == ir::ScalarType::float32 ? static_cast<float>(x) : x; }

Eigen::VectorXd rounded(const Eigen::VectorXd& x, ir::ScalarType scalar) {
  return x.unaryExpr([&](double element) { return rounded(element, scalar); });
}

// Angles keep off the axes by a tenth of a right angle; later states lie whole turns away.
ir::SelfTest::State make_state(const ir::KinematicTree& tree, int turns, Uniform& uniform) {
  ir::SelfTest::State state{Eigen::VectorXd(tree.nq()), Eigen::VectorXd(tree.nv()), Eigen::VectorXd(tree.nv())};
  int coordinate = 0;
  if (tree.base_coordinates() > 0) {
    for (int i = 0; i < 7; ++i) state.q[i] = uniform.either_sign(0.3, 0.8);
    coordinate = 7;
  }
  for (const ir::Body& body : tree.bodies) {
    if (body.driven()) continue;
    if (body.of_quaternion()) {
      for (int i = 0; i < body.positions(); ++i) state.q[coordinate++] = uniform.either_sign(0.3, 0.8);
      continue;
    }
    const double quadrant = std::floor(uniform(-2, 2)), angle = (quadrant + uniform(0.1, 0.9)) * std::numbers::pi / 2;
    state.q[coordinate++] =
        body.turns() ? angle + uniform.either_sign(turns, turns) * 2 * std::numbers::pi : uniform.either_sign(0.1, 0.5);
  }
  for (const int first : tree.quaternions()) state.q.segment<4>(first).normalize();
  if (!tree.linkages.empty()) ir::draw_closed(tree, state.q, 400, ir::well_off_toggle_points, true);
  for (int i = 0; i < tree.nv(); ++i) state.v[i] = uniform.either_sign(1, 5);
  state.input = state.v.reverse();
  return state;
}

// The robot with its run-time inputs set: gravity in the scene, payloads in the tree.
void set_inputs(ir::SelfTest& test, ir::KinematicTree& tree, ir::Scene& scene) {
  const auto round = [&](double x) { return rounded(x, scene.scalar); };
  test.gravity = rounded(Eigen::Vector3d(1.3, -2.1, -8.7), scene.scalar);
  test.wrenches.resize(6 * static_cast<Eigen::Index>(scene.wrenches.size()));
  for (Eigen::Index i = 0; i < test.wrenches.size(); ++i)
    test.wrenches[i] = round((i % 2 ? -2.25 : 3.5) * static_cast<double>(i + 1));
  for (std::size_t i = 0; i < scene.payloads.size(); ++i) {
    const ir::Inertia payload = make_payload(tree, static_cast<int>(i));
    test.payloads.push_back({round(payload.mass), payload.com.unaryExpr(round), payload.inertia.unaryExpr(round)});
  }
  ir::Loading loading{test.payloads, {}};
  if (scene.gravity_kind == ir::GravityKind::run_time) loading.gravity = test.gravity;
  load(loading, tree, scene);
}

// Bodies with each of their ancestors, which is what the generic engine's time goes with.
long pairs(const ir::KinematicTree& tree) {
  std::vector<long> depth;
  long sum = 0;
  for (const ir::Body& body : tree.bodies) {
    depth.push_back(body.parent < 0 ? 1 : depth[static_cast<size_t>(body.parent)] + 1);
    sum += depth.back();
  }
  return sum;
}

Precision precision(const ir::KinematicTree& tree) {
  const bool extended_is_longer = std::numeric_limits<long double>::digits > std::numeric_limits<double>::digits;
  return pairs(tree) > most_pairs && extended_is_longer ? Precision::extended : Precision::digits_50;
}

Eigen::VectorXd products(const Eigen::MatrixXd& matrix) {
  Eigen::VectorX<long double> sum = Eigen::VectorX<long double>::Zero(matrix.rows());
  for (Eigen::Index c = 0; c < matrix.cols(); ++c)
    sum += matrix.col(c).cast<long double>() * static_cast<long double>(self_test_weight(static_cast<int>(c)));
  return sum.cast<double>();
}

double epsilon_of(ir::ScalarType scalar) {
  return scalar == ir::ScalarType::float32 ? std::numeric_limits<float>::epsilon() : std::numeric_limits<double>::epsilon();
}

// What is allowed, relative to the largest element, for what a condition does to rounding. All that it can do seldom comes to
// pass, and a product of conditions still less: beyond a few digits what the generic engine loses in the same scalar says more.
double allowed_by_condition(const Wanted& wanted, const ir::KinematicTree& tree, const ir::Scene& scene, const Inputs& inputs) {
  const double all = 5 * condition(wanted, tree, scene, inputs) * epsilon_of(scene.scalar);
  if (!std::isfinite(all)) return 0;
  return depends_on_steps(wanted, tree, scene, inputs) ? all : std::min(all, 1.0 / 16);
}

// Elements of an output at one state, and what it is by the generic engine in the scalar.
class Comparison {
 public:
  Comparison(int array, int state, const Eigen::MatrixXd& exact, const Eigen::MatrixXd& generic, double least_scale,
             double by_condition, ir::ScalarType scalar)
      : array_(array),
        state_(state),
        exact_(exact),
        generic_(generic),
        least_scale_(least_scale),
        by_condition_(by_condition),
        scalar_(scalar) {}

  ir::Expectation elements(bool symmetric) const {
    const Eigen::Index rows = exact_.rows(), columns = exact_.cols();
    ir::Expectation e{array_, state_, symmetric ? Kind::symmetric_elements : Kind::elements, {}, true, {}};
    e.complete = (exact_.array() != 0).count() / (symmetric ? 2 : 1) <= most_elements;
    measure(e, exact_, generic_, exact_.cwiseAbs().maxCoeff());
    const Eigen::Index sampled = std::clamp<Eigen::Index>(sampled_elements / rows, 2, most_columns),
                       count = e.complete ? columns : std::min(sampled, columns);
    for (Eigen::Index c = 0; c < count; ++c) {
      const Eigen::Index column = e.complete ? c : (2 * c + 1) * columns / (2 * count);
      e.columns.push_back(static_cast<int>(column));
      for (Eigen::Index row = symmetric ? column : 0; row < rows; ++row)
        e.values.push_back(clean(exact_(row, column), e.scale));
    }
    return e;
  }

  ir::Expectation rows() const {
    ir::Expectation e{array_, state_, Kind::products, {}, true, {}};
    const Eigen::VectorXd exact = products(exact_);
    measure(e, exact, products(generic_), exact_.cwiseAbs().rowwise().sum().maxCoeff());
    for (const double x : exact) e.values.push_back(clean(x, e.scale));
    return e;
  }

 private:
  double epsilon() const { return epsilon_of(scalar_); }

  void measure(ir::Expectation& e, const Eigen::MatrixXd& exact, const Eigen::MatrixXd& generic, double largest) const {
    e.scale = std::max(largest, least_scale_);
    if (e.scale == 0) e.scale = 1;  // all zeros, exactly
    const double error = (generic - exact).cwiseAbs().maxCoeff() / e.scale;
    e.tolerance = 512 * epsilon();
    // The least scale is a thousandth of the terms that cancel: what vanishes is as wrong as a few of their last places.
    e.tolerance = std::max(e.tolerance, 4096 * epsilon() * least_scale_ / e.scale);
    e.tolerance = std::max(e.tolerance, by_condition_);
    if (std::isfinite(error)) e.tolerance = std::max(e.tolerance, 64 * error);
  }

  // What is zero but for the rounding of many digits is zero.
  double clean(double x, double scale) const { return std::abs(x) < epsilon() / 1024 * scale ? 0 : x; }

  int array_, state_;
  const Eigen::MatrixXd &exact_, &generic_;
  double least_scale_;
  double by_condition_;
  ir::ScalarType scalar_;
};

// Leaves out outputs of which the scalar cannot hold a number: right code overflows too.
void leave_out_what_overflows(ir::SelfTest& test, ir::ScalarType scalar) {
  const auto overflows = [&](const ir::Expectation& e) {
    return !std::isfinite(e.scale) ||
           std::any_of(e.values.begin(), e.values.end(), [&](double x) { return !std::isfinite(rounded(x, scalar)); });
  };
  std::set<int> arrays;
  for (const ir::Expectation& e : test.expectations)
    if (overflows(e)) arrays.insert(e.array);
  std::erase_if(test.implicit, [&](const ir::Expectation& e) { return overflows(e) || arrays.contains(e.array); });
  test.left_out.assign(arrays.begin(), arrays.end());
  std::erase_if(test.expectations, [&](const ir::Expectation& e) { return arrays.contains(e.array); });
}

// dv/dt of a linearly implicit step is that of a robot with more armature and other forces (ir/implicit_joints.hpp). The change
// of v in a step is rounded as v is.
ir::Expectation implicit_step(int array, int state, double step, ir::KinematicTree tree, const ir::Scene& scene, Inputs inputs,
                              Precision exactly, Precision usual) {
  const double fastest = inputs.v.cwiseAbs().maxCoeff();
  for (const ir::ImplicitJoint& joint : ir::implicit_joints(tree)) {
    tree.bodies[static_cast<size_t>(joint.body)].armature += step * (joint.damping + step * joint.stiffness);
    inputs.more[joint.coordinate] -= step * joint.stiffness * inputs.v[joint.coordinate];
  }
  const Wanted wanted{ir::Quantity::forward_dynamics, "", {}, {}};
  const Eigen::MatrixXd exact = evaluate(tree, scene, {wanted}, inputs, exactly).front(),
                        generic = evaluate(tree, scene, {wanted}, inputs, usual).front();
  ir::Expectation e = Comparison(array, state, exact, generic, LeastScale(tree, scene, inputs).of(wanted),
                                 allowed_by_condition(wanted, tree, scene, inputs), scene.scalar)
                          .elements(false);
  e.tolerance += 2 * epsilon_of(scene.scalar) * (fastest / step + e.scale) / e.scale;
  return e;
}

}  // namespace

ir::SelfTest self_test(const ir::KinematicTree& original, const ir::Scene& original_scene) {
  ir::KinematicTree tree = original;
  ir::Scene scene = original_scene;
  ir::SelfTest test;
  set_inputs(test, tree, scene);
  std::vector<Wanted> wanted;
  std::vector<int> moving;  // arrays of functions that roll out by linearly implicit steps
  for (const ir::EmittedFunction& function : ir::functions_of(scene)) {
    for (const ir::Quantity quantity : function.quantities) {
      if (scene.linearly_implicit && quantity == ir::Quantity::forward_dynamics)
        moving.push_back(static_cast<int>(wanted.size()));
      const ir::QuantityRow& row = ir::row_of(quantity);
      wanted.push_back({quantity, "", {}, ir::selection(function.part(quantity), row.rows, row.columns)});
    }
    for (const ir::LinkOutput& output : function.of_links) {
      const ir::LinkQuantityRow& row = ir::row_of(output.quantity);
      wanted.push_back({std::nullopt, output.link, output.quantity,
                        ir::selection(output.part ? &*output.part : nullptr, row.rows, row.columns)});
    }
  }

  const Precision exactly = precision(tree);
  if (!moving.empty()) test.step = 0x1p-6;
  test.precision = exactly == Precision::digits_50 ? "50 digits" : "long double";
  const Precision usual = scene.scalar == ir::ScalarType::float32 ? Precision::float32 : Precision::float64;
  Uniform uniform;
  const int states = tree.nv() > many_coordinates ? most_states_of_many_coordinates : most_states;
  for (int s = 0; s < states; ++s) {
    ir::SelfTest::State state = make_state(tree, s, uniform);
    state.q = rounded(state.q, scene.scalar);
    state.v = rounded(state.v, scene.scalar);
    state.input = rounded(state.input, scene.scalar);
    const Inputs inputs{state.q, state.v, state.input, test.wrenches};
    const std::vector<Eigen::MatrixXd> exact = evaluate(tree, scene, wanted, inputs, exactly),
                                       generic = evaluate(tree, scene, wanted, inputs, usual);
    LeastScale least(tree, scene, inputs);
    for (size_t a = 0; a < wanted.size(); ++a) {
      const Comparison comparison(static_cast<int>(a), s, exact[a], generic[a], least.of(wanted[a]),
                                  allowed_by_condition(wanted[a], tree, scene, inputs), scene.scalar);
      const bool vector = exact[a].cols() == 1, symmetric = wanted[a].quantity == ir::Quantity::mass_matrix;
      if (s == 0 || vector) test.expectations.push_back(comparison.elements(symmetric));
      if (!vector) test.expectations.push_back(comparison.rows());
    }
    for (const int array : moving)
      test.implicit.push_back(implicit_step(array, s, test.step, tree, scene, inputs, exactly, usual));
    test.states.push_back(std::move(state));
  }
  leave_out_what_overflows(test, scene.scalar);
  return test;
}

}  // namespace dalembert::reference
