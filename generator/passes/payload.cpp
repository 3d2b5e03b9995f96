#include "passes/payload.hpp"

#include <vector>

#include "passes/parameters.hpp"

namespace dalembert::passes {
namespace {

ir::Moments base_moments(const ir::Inertia& base) {
  ir::Moments own;
  own.mass = base.mass;
  own.first = own.mass * base.com;
  own.half_trace = 0.5 * base.inertia.trace();
  own.second = own.half_trace * Eigen::Matrix3d::Identity() - base.inertia + own.mass * base.com * base.com.transpose();
  return own;
}

}  // namespace

std::map<int, ir::NodeId> payload_parameters(ir::Graph& graph, const ir::KinematicTree& tree, const ir::NormalTree& normal,
                                             const ir::Scene& scene, int body) {
  const auto constant = [&](double value) { return Sym{&graph, graph.constant(value)}; };
  const auto constant3 = [&](const Eigen::Vector3d& v) { return Vec3{constant(v[0]), constant(v[1]), constant(v[2])}; };
  const ir::NormalBody* n = body < 0 ? nullptr : &normal.bodies[static_cast<size_t>(body)];
  const ir::Moments own = n ? n->own : base_moments(tree.base);
  const Eigen::Matrix3d link_rotation = n ? n->link_rotation : Eigen::Matrix3d(Eigen::Matrix3d::Identity());
  const Eigen::Vector3d link_translation = n ? n->link_translation : Eigen::Vector3d(Eigen::Vector3d::Zero());

  // Moments of the whole body, payload welded on: their trace about the common centre of mass is the body's half trace. A body
  // without mass has no such centre while its payloads are empty: a mass below all rounding makes 0/0 a zero.
  constexpr double no_mass = 1e-36;
  Sym mass = constant(own.mass != 0 ? own.mass : no_mass), trace = constant(own.second.trace());
  Vec3 first = constant3(own.first);
  Sym added_mass = constant(0);
  Vec3 added_first = constant3(Eigen::Vector3d::Zero());
  Sym6 added_second;
  added_second.fill(constant(0));
  std::vector<const ir::LinkPlacement*> on_body;
  for (const ir::LinkPlacement& link : tree.links)
    if (link.body == body) on_body.push_back(&link);
  bool any = false;
  for (size_t i = 0; i < scene.payloads.size(); ++i)
    for (const ir::LinkPlacement* on : on_body) {
      const ir::LinkPlacement& link = *on;
      if (link.link != scene.payloads[i]) continue;
      any = true;
      const auto value = [&](int component) {
        return Sym{&graph, graph.input({ir::InputKind::payload, static_cast<int>(i), component})};
      };
      const Eigen::Matrix3d placed = link_rotation * link.placement.linear();
      const Mat3 r{constant3(placed.row(0)), constant3(placed.row(1)), constant3(placed.row(2))};
      const Vec3 p = constant3(link_rotation * link.placement.translation() + link_translation);
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
          added_second[sym6_index[a][b]] = added_second[sym6_index[a][b]] + rotated[a][b] + shift;
        }
        const Sym shift = h[a] * x[a];
        trace = trace + rotated[a][a] + shift;
      }
      added_first = added_first + h;
      added_mass = added_mass + m;
      first = first + h;
      mass = mass + m;
    }
  if (!any) return {};
  // On a joint that slides the body's own half trace has moved to the parent; what the payload adds to it stays here.
  const Sym total = trace - Sym{&graph, graph.divide(dot(first, first).id, mass.id)};
  const Sym half = constant(0.5);
  std::map<int, ir::NodeId> added{{mass_p, added_mass.id}, {half_trace_p, (total - constant(own.half_trace)).id}};
  for (int i = 0; i < 3; ++i) added[first_p + i] = added_first[static_cast<size_t>(i)].id;
  for (int i = 0; i < 6; ++i) added[second_p + i] = added_second[static_cast<size_t>(i)].id;
  for (int i = 0; i < 3; ++i) added[half_second_p + i] = (half * added_second[sym6_index[i][i]]).id;
  return added;
}

}  // namespace dalembert::passes
