#include "passes/lower_inputs.hpp"

namespace dalembert::passes {

using ir::InputKind;

LowerInputs::LowerInputs(ir::Graph& graph, const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene)
    : graph_(graph), tree_(tree), normal_(normal), scene_(scene), coordinates_(tree.coordinates()) {}

Mat3 LowerInputs::constant(const Eigen::Matrix3d& m) const {
  return {constant(Eigen::Vector3d(m.row(0))), constant(Eigen::Vector3d(m.row(1))), constant(Eigen::Vector3d(m.row(2)))};
}

Sym LowerInputs::input(InputKind kind, int index, int component) const {
  return {&graph_, graph_.input({kind, index, component})};
}

JointPosition LowerInputs::position(size_t k) const {
  const ir::Body& body = tree_.bodies[k];
  Sym q = input(InputKind::position, (tree_.floating_base ? 7 : 0) + coordinates_[k]);
  if (body.driven()) {
    const Sym offset = constant(body.offset);
    q = constant(body.multiplier) * q + offset;
  }
  if (body.prismatic()) return {constant(0), constant(1), q};
  return {{&graph_, graph_.sine(q.id)}, {&graph_, graph_.cosine(q.id)}, constant(0)};
}

Sym LowerInputs::rate(size_t k) const {
  if (scene_.rates_zero) return constant(0);
  const ir::Body& body = tree_.bodies[k];
  const Sym v = input(InputKind::velocity, (tree_.floating_base ? 6 : 0) + coordinates_[k]);
  return body.driven() ? constant(body.multiplier) * v : v;
}

Twist LowerInputs::base_twist() const {
  if (!tree_.floating_base || scene_.rates_zero) return {zero(), zero()};
  Twist v;
  for (int i = 0; i < 3; ++i) {
    v.linear[static_cast<size_t>(i)] = input(InputKind::velocity, i);
    v.angular[static_cast<size_t>(i)] = input(InputKind::velocity, 3 + i);
  }
  return v;
}

Vec3 LowerInputs::gravity_in_base() const {
  Vec3 g = zero();
  if (scene_.gravity_kind == ir::GravityKind::run_time)
    g = {input(InputKind::gravity, 0, 0), input(InputKind::gravity, 0, 1), input(InputKind::gravity, 0, 2)};
  if (scene_.gravity_kind == ir::GravityKind::constant) g = constant(scene_.gravity);
  if (!tree_.floating_base) return g;
  // Rᵀ g with R from the unit quaternion (x, y, z, w).
  const Sym x = input(InputKind::position, 3), y = input(InputKind::position, 4), z = input(InputKind::position, 5),
            w = input(InputKind::position, 6);
  const Sym one = constant(1), two = constant(2);
  const auto diagonal = [&](Sym a, Sym b) { return one - two * sum_of_products(a, a, b, b); };
  const auto sum = [&](Sym a, Sym b, Sym c, Sym d) { return two * sum_of_products(a, b, c, d); };
  const auto difference = [&](Sym a, Sym b, Sym c, Sym d) { return two * difference_of_products(a, b, c, d); };
  const Mat3 r{Vec3{diagonal(y, z), difference(x, y, z, w), sum(x, z, y, w)},
               Vec3{sum(x, y, z, w), diagonal(x, z), difference(y, z, x, w)},
               Vec3{difference(x, z, y, w), sum(y, z, x, w), diagonal(x, y)}};
  return transpose(r) * g;
}

BodyConstants LowerInputs::constants(const ir::NormalBody& n, int body) const {
  BodyConstants c;
  c.rotation = constant(n.rotation);
  c.translation = constant(n.translation);
  c.revolute = constant(n.prismatic ? 0 : 1);
  c.prismatic = constant(n.prismatic ? 1 : 0);
  c.mass = constant(n.moments.mass);
  c.first = constant(n.moments.first);
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = i; j < 3; ++j)
      c.second[sym6_index[i][j]] = constant(n.moments.second(static_cast<int>(i), static_cast<int>(j)));
  c.half_trace = constant(n.moments.half_trace);
  add_payloads(c, body, n.own, n.link_rotation, n.link_translation);
  const Sym half = constant(0.5);
  c.half_second = {half * c.second[0], half * c.second[3], half * c.second[5]};
  return c;
}

BodyConstants LowerInputs::base() const {
  ir::NormalBody n;
  n.moments = normal_.base;
  n.own.mass = tree_.base.mass;
  const Eigen::Vector3d com = tree_.base.com;
  const Eigen::Matrix3d inertia = tree_.base.inertia;
  n.own.first = n.own.mass * com;
  n.own.half_trace = 0.5 * inertia.trace();
  n.own.second = n.own.half_trace * Eigen::Matrix3d::Identity() - inertia + n.own.mass * com * com.transpose();
  return constants(n, -1);
}

void LowerInputs::add_payloads(BodyConstants& c, int body, const ir::Moments& own, const Eigen::Matrix3d& link_rotation,
                               const Eigen::Vector3d& link_translation) const {
  // Moments of the whole body, payload welded on: their trace about the common centre of mass is the body's half trace.
  // A body without mass has no such centre while its payloads are empty: a mass below all rounding makes 0/0 a zero.
  Sym mass = constant(own.mass > 0 ? own.mass : 1e-36), trace = constant(own.second.trace());
  Vec3 first = constant(own.first);
  bool any = false;
  for (size_t i = 0; i < scene_.payloads.size(); ++i)
    for (const ir::LinkPlacement& link : tree_.links) {
      if (link.link != scene_.payloads[i] || link.body != body) continue;
      any = true;
      const int index = static_cast<int>(i);
      const auto value = [&](int component) { return input(InputKind::payload, index, component); };
      const Mat3 r = constant(Eigen::Matrix3d(link_rotation * link.placement.linear()));
      const Vec3 p = constant(Eigen::Vector3d(link_rotation * link.placement.translation() + link_translation));
      const Sym m = value(0), half = constant(0.5);
      const Sym6 inertia{value(4), value(5), value(6), value(7), value(8), value(9)};
      const Sym half_trace = half * (inertia[0] + inertia[3] + inertia[5]);
      const Vec3 com{value(1), value(2), value(3)}, x = r * com + p;
      Sym6 central = inertia;
      for (size_t j = 0; j < 6; ++j) central[j] = -central[j];
      for (size_t j : {0u, 3u, 5u}) central[j] = half_trace + central[j];
      const Mat3 rotated = r * full(central) * transpose(r);
      const Vec3 h = m * x;
      for (size_t a = 0; a < 3; ++a) {
        for (size_t b = a; b < 3; ++b) {
          const Sym shift = h[a] * x[b];
          c.second[sym6_index[a][b]] = c.second[sym6_index[a][b]] + rotated[a][b] + shift;
        }
        const Sym shift = h[a] * x[a];
        trace = trace + rotated[a][a] + shift;
      }
      c.first = c.first + h;
      c.mass = c.mass + m;
      first = first + h;
      mass = mass + m;
    }
  // On a prismatic joint the body's own half trace has moved to the parent; what the payload adds to it stays here.
  if (any) {
    const Sym total = trace - Sym{&graph_, graph_.divide(dot(first, first).id, mass.id)};
    const double gone = own.half_trace;  // counted already, here or at the parent
    c.half_trace = c.half_trace + (total - constant(gone));
  }
}

}  // namespace dalembert::passes
