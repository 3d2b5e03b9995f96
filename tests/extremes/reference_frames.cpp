// What another reference frame would be worth to M where small links follow large ones, and what it would cost: the second
// table of docs/exactness.md.
//
//   reference_frames [--states N]
//
// M by composite inertias, in double, with moments, joint axes and forces in one of three frames: the base's, as the compiler
// has it; that of the first body of every limb; that of every body (Featherstone 2008, section 6.2). What crosses from one
// frame to the next is transformed: an inertia once per frame, a force once per frame above its own. Errors against 50 digits:
// worst over the states and elements, in ulp of the largest element, and with row and column i divided by sqrt(M_ii).
// Multiplications: those of Phase III, and of what crosses. Fails where a frame per body does not give the small elements.
#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <dalembert/spatial.hpp>

#include "commands/random_states.hpp"
#include "extremes.hpp"
#include "passes/normalise.hpp"
#include "reference/digits50.hpp"

namespace dalembert::extremes {
namespace {

enum class Reference { base, limb, body };

// Whether the body's own frame is the reference, of its own quantities and of those of bodies beyond it.
std::vector<bool> begins_frame(const ir::KinematicTree& tree, Reference reference) {
  std::vector<int> children(tree.bodies.size(), 0);
  for (const ir::Body& body : tree.bodies)
    if (body.parent >= 0) ++children[static_cast<size_t>(body.parent)];
  std::vector<bool> begins;
  for (const ir::Body& body : tree.bodies)
    begins.push_back(reference == Reference::body ||
                     (reference == Reference::limb && (body.parent < 0 || children[static_cast<size_t>(body.parent)] != 1)));
  return begins;
}

// As ir::Moments.
template <class S>
struct Moments {
  S mass = S(0);
  Vector3<S> first = Vector3<S>::Zero();
  Matrix3<S> second = Matrix3<S>::Zero();
};

template <class S>
Moments<S> moved(const Moments<S>& m, const Transform<S>& by) {
  const Vector3<S> turned = by.rotation * m.first;
  const Matrix3<S> mixed = turned * by.translation.transpose();
  return {m.mass, turned + m.mass * by.translation,
          by.rotation * m.second * by.rotation.transpose() + mixed + mixed.transpose() +
              m.mass * by.translation * by.translation.transpose()};
}

// The joints' block of M; counts multiplications: 6 for an element, 24 for a force that crosses, 60 for an inertia.
template <class S>
MatrixX<S> mass_matrix(const ir::KinematicTree& tree, const ir::NormalTree& normal, const Eigen::VectorXd& q,
                       const std::vector<bool>& begins, long& products) {
  const int n = tree.joints();
  const Eigen::Index first = tree.nq() - n;
  std::vector<Transform<S>> pose(static_cast<size_t>(n)), crossing(pose);  // in the reference frame; of it in the next
  std::vector<Moments<S>> composite(static_cast<size_t>(n));
  MatrixX<S> linear(3, n), angular(3, n);  // of the joint's twist
  for (int k = 0; k < n; ++k) {
    const auto at = static_cast<size_t>(k);
    const ir::NormalBody& body = normal.bodies[at];
    const S angle(q[first + k]);
    const Transform<S> own{body.rotation.cast<S>() * rotation_about<S>(Vector3<S>::UnitZ(), angle), body.translation.cast<S>()};
    pose[at] = body.parent < 0 ? own : pose[static_cast<size_t>(body.parent)] * own;
    if (begins[at]) crossing[at] = pose[at], pose[at] = {};
    angular.col(k) = pose[at].rotation.col(2);
    linear.col(k) = pose[at].translation.cross(Vector3<S>(angular.col(k)));
    composite[at] = moved<S>({S(body.moments.mass), body.moments.first.cast<S>(), body.moments.second.cast<S>()}, pose[at]);
  }
  MatrixX<S> M = MatrixX<S>::Zero(n, n);
  for (int k = n; k-- > 0;) {
    const auto at = static_cast<size_t>(k);
    const Moments<S> own = composite[at];
    if (const int parent = normal.bodies[at].parent; parent >= 0) {
      Moments<S>& sum = composite[static_cast<size_t>(parent)];
      const Moments<S> more = begins[at] ? moved(own, crossing[at]) : own;
      sum = {sum.mass + more.mass, sum.first + more.first, sum.second + more.second};
      if (begins[at]) products += 60;
    }
    const Vector3<S> u = linear.col(k), w = angular.col(k);
    Vector3<S> force = own.mass * u + w.cross(own.first), moment = own.first.cross(u) + own.second.trace() * w - own.second * w;
    for (int i = k; i >= 0; i = normal.bodies[static_cast<size_t>(i)].parent) {
      M(i, k) = M(k, i) = force.dot(linear.col(i)) + moment.dot(angular.col(i));
      products += 6;
      const Transform<S>& by = crossing[static_cast<size_t>(i)];
      if (!begins[static_cast<size_t>(i)] || normal.bodies[static_cast<size_t>(i)].parent < 0) continue;
      force = (by.rotation * force).eval();
      moment = (by.rotation * moment + by.translation.cross(force)).eval();
      products += 24;
    }
  }
  return M;
}

struct Errors {
  double largest = 0, normalised = 0;
  long products = 0;
};

Errors measured(const ir::KinematicTree& tree, Reference reference, int states) {
  const std::vector<bool> begins = begins_frame(tree, reference), whole(begins.size(), false);
  const ir::NormalTree normal = passes::normalise(tree, {true, true});
  Errors errors;
  for (const State& state : random_states(tree, states)) {
    long unused = 0;
    errors.products = 0;
    const MatrixX<double> ours = mass_matrix<double>(tree, normal, state.q, begins, errors.products);
    const MatrixX<reference::Digits50> exact = mass_matrix<reference::Digits50>(tree, normal, state.q, whole, unused);
    const MatrixX<double> difference = (ours.cast<reference::Digits50>() - exact).cast<double>();
    const Eigen::VectorXd d = exact.cast<double>().diagonal().cwiseSqrt().cwiseInverse();
    const double largest = exact.cast<double>().cwiseAbs().maxCoeff();
    errors.largest = std::max(errors.largest, difference.cwiseAbs().maxCoeff() / largest * 0x1p53);
    errors.normalised =
        std::max(errors.normalised, (d.asDiagonal() * difference * d.asDiagonal()).cwiseAbs().maxCoeff() * 0x1p53);
  }
  return errors;
}

// The last frame's small elements are right.
bool print(const std::string& name, const std::string& what, const ir::KinematicTree& tree, int states) {
  fmt::print("| {} | {} |", name, what);
  long base = 0;
  bool right = false;
  for (const Reference reference : {Reference::base, Reference::limb, Reference::body}) {
    const Errors e = measured(tree, reference, states);
    if (reference == Reference::base) base = e.products;
    fmt::print(" {:.2g} | {:.2g} | {:.2g} |", e.largest, e.normalised,
               static_cast<double>(e.products) / static_cast<double>(base));
    right = e.normalised < 1e3;
  }
  fmt::print("\n");
  return right;
}

// With a chain of three links more on some bodies: a limb each on the third and the seventh, at the end of one on the last.
ir::KinematicTree with_hands(ir::KinematicTree tree, const std::vector<int>& on, double size) {
  for (const int k : on)
    for (int finger = 0; finger < 3; ++finger) {
      ir::Body body = tree.bodies[static_cast<size_t>(k)];
      body.parent = finger == 0 ? k : static_cast<int>(tree.bodies.size()) - 1;
      body.placement.translation() *= finger == 0 ? 1 : size;
      body.inertia.com *= size;
      body.inertia.mass *= size * size * size;
      body.inertia.inertia *= std::pow(size, 5);
      tree.bodies.push_back(body);
    }
  return tree;
}

}  // namespace
}  // namespace dalembert::extremes

int main(int argc, char** argv) {
  using namespace dalembert::extremes;
  int states = 100;
  if (argc == 3 && !std::strcmp(argv[1], "--states") && std::atoi(argv[2]) > 0) states = std::atoi(argv[2]);
  else if (argc > 1) return std::fprintf(stderr, "usage: reference_frames [--states N]\n"), 2;
  fmt::print("| robot | what it is | base: M | M | products | branch: M | M | products | body: M | M | products |\n");
  fmt::print("|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n");
  bool right = true;
  for (const Robot& robot : robots()) {
    const std::string& name = robot.name;
    if (name != "ordinary" && name != "length_down" && name != "far_joint" && name != "far_base" && name != "mass_down")
      continue;
    const dalembert::ir::KinematicTree tree = model_of(robot).tree;
    right &= print(name, robot.what, tree, states);
    if (name != "ordinary") continue;
    for (const double size : {1.0, 1e-3, 1e-6})
      right &= print("hands", fmt::format("the same with hands of three links on links 3 and 7, lengths {:g} of normal", size),
                     with_hands(tree, {2, 6}, size), states);
    right &= print("tip", "the same with a hand at its end, lengths 1e-06 of normal", with_hands(tree, {9}, 1e-6), states);
  }
  return right ? 0 : 1;
}
