// W: transposed body Jacobians (Shin, Park and Park 2016, eq. 17). Six columns per body: the twist of its link in the link's
// own axes, per unit rate of every joint above.
#include "passes/quantities/quantities.hpp"
#include "passes/quantities/shared.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::InputKind;
using ir::Shape;

LinkRoles link_frames(Builder& b) {
  const Poses p = poses(b);
  const LinkRoles r{b.role({"link_axes", "X", "axes of the body's link, one after another", "", Shape::matrix}),
                    b.role({"link_origin", "x", "origin of the body's link", "m", Shape::vector})};
  if (b.has("links")) return r;
  SweepBuilder s = b.sweep("links", "X = R Rl, x = p + R pl", Direction::anywhere);
  const Pose body = pose_of(s, p);
  const Mat3 rotation = body.rotation * s.parameter9(link_rotation_p);
  for (int l = 0; l < 3; ++l) s.store(r.axes, column(rotation, static_cast<std::size_t>(l)), 3 * l);
  const Vec3 offset = body.rotation * s.parameter3(link_translation_p);
  s.store(r.origin, body.position + offset);
  return r;
}

Twist joint_in_link(Builder& b, const LinkRoles& links, const ThreeInputs& three) {
  const Poses p = poses(b);
  const Mat3 to_link{three(InputKind::state, links.axes, 0), three(InputKind::state, links.axes, 3),
                     three(InputKind::state, links.axes, 6)};
  const Vec3 turning = three(InputKind::carried, p.joint_angular, 0);
  const Vec3 lever = cross(turning, three(InputKind::state, links.origin, 0));
  const Vec3 angular = to_link * turning, linear = to_link * (three(InputKind::carried, p.joint_linear, 0) + lever);
  return {linear, angular};
}

void describe_wrench_influence(Builder& b, int array) {
  const LinkRoles links = link_frames(b);
  ir::Projection w;
  w.array = array;
  w.equation = "W_i = X' [Jv + Jw x x; Jw]";
  w.graph = b.new_graph();
  const Twist joint = joint_in_link(b, links, [&](InputKind kind, int role, int from) {
    const auto input = [&](int i) { return Sym{&w.graph, w.graph.input({kind, role, from + i})}; };
    return Vec3{input(0), input(1), input(2)};
  });
  for (const Vec3* part : {&joint.linear, &joint.angular})
    for (const Sym& x : *part) w.columns.push_back(x.id);
  b.projection(w);
}

}  // namespace dalembert::passes
