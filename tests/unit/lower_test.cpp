// The scalar program interpreted in double, against the generic engine, where numbers are awkward: no code is compiled.
#include "passes/lower.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <robots.hpp>

#include "commands/generic_engine.hpp"
#include "commands/output.hpp"
#include "frontend/urdf_reader.hpp"
#include "interpret.hpp"
#include "passes/build_tree.hpp"
#include "passes/combine_inertia.hpp"
#include "passes/normalise.hpp"

namespace dalembert {
namespace {

using Payload = std::array<double, 10>;  // mass, centre of mass, inertia xx xy xz yy yz zz

ir::RobotDescription robot(std::string_view name) {
  Diagnostics warnings;
  for (const TestRobot& r : test_robots)
    if (r.name == name) return frontend::read_urdf(r.urdf, warnings);
  throw std::invalid_argument(std::string(name));
}

Model model_of(const ir::RobotDescription& description, const ir::Scene& scene) {
  Diagnostics warnings;
  Model model;
  model.description = description;
  model.scene = scene;
  model.tree = passes::build_tree(description, scene, warnings);
  return model;
}

State some_state(const ir::KinematicTree& tree) {
  State state{"", Eigen::VectorXd(tree.nq()), Eigen::VectorXd(tree.nv())};
  for (int i = 0; i < tree.nq(); ++i) state.q[i] = std::sin(1.0 + 1.7 * i);
  for (int i = 0; i < tree.nv(); ++i) state.v[i] = std::cos(2.0 + 1.3 * i);
  if (tree.floating_base) state.q.segment<4>(3).normalize();
  return state;
}

// The payload welded to the link.
ir::KinematicTree welded(ir::KinematicTree tree, const std::string& link, const Payload& p) {
  ir::Inertia inertia{p[0], {p[1], p[2], p[3]}, {}};
  inertia.inertia << p[4], p[5], p[6], p[5], p[7], p[8], p[6], p[8], p[9];
  for (const ir::LinkPlacement& at : tree.links) {
    if (at.link != link) continue;
    inertia.com = at.placement * inertia.com;
    inertia.inertia = at.placement.linear() * inertia.inertia * at.placement.linear().transpose();
    ir::Inertia& body = at.body < 0 ? tree.base : tree.bodies[static_cast<size_t>(at.body)].inertia;
    body = passes::combined({body, inertia});
  }
  return tree;
}

// Every output of the scene, with `payload` at each link that carries one.
void expect_generic_values(const Model& model, const Payload& payload = {}) {
  Model expected = model;
  for (const std::string& link : model.scene.payloads) expected.tree = welded(expected.tree, link, payload);
  const State state = some_state(model.tree);
  const ir::Program program = passes::lower(model.tree, passes::normalise(model.tree, {}), model.scene, {});
  const std::vector<double> values = ir::interpret<double>(program.graph, [&](const ir::Input& input) {
    if (input.kind == ir::InputKind::position) return state.q[input.index];
    if (input.kind == ir::InputKind::velocity) return state.v[input.index];
    return payload[static_cast<size_t>(input.component)];
  });
  for (const Output& output : outputs_of(model)) {
    SCOPED_TRACE(output.name);
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(output.rows, output.columns);
    for (const ir::OutputElement& e : program.elements)
      if (program.arrays[static_cast<size_t>(e.array)].name == output.name)
        result(e.row, e.column) = values[static_cast<size_t>(e.node)];
    const Eigen::MatrixXd reference = evaluate_generic(expected, output, state);
    EXPECT_LE((result - reference).cwiseAbs().maxCoeff<Eigen::PropagateNaN>(), 1e-12 * reference.cwiseAbs().maxCoeff());
  }
}

constexpr Payload tool{1.7, 0.03, -0.02, 0.11, 0.02, 0.003, -0.001, 0.03, 0.002, 0.025};

// Its largest component rounds to 1, and yet it is no coordinate axis.
TEST(Lower, AnAxisAlmostAlongACoordinateAxisKeepsItsDirection) {
  for (const Eigen::Vector3d& axis : {Eigen::Vector3d(1, 1e-9, -2e-9), Eigen::Vector3d(1e-8, -1, 0)}) {
    ir::RobotDescription chain = robot("chain_7");
    for (ir::Joint& joint : chain.joints) joint.axis = axis.normalized();
    expect_generic_values(model_of(chain, {}));
  }
}

TEST(Lower, APayloadAtTheFloatingBaseEqualsTheSameWeldedOn) {
  ir::Scene scene;
  scene.payloads = {"base"};
  expect_generic_values(model_of(robot("branch_below_base"), scene), tool);
}

TEST(Lower, APayloadOnALinkWithoutMassMayBeEmpty) {
  ir::RobotDescription chain = robot("chain_7");
  chain.links.back().inertia.reset();
  ir::Scene scene;
  scene.payloads = {chain.links.back().name};
  expect_generic_values(model_of(chain, scene));
  expect_generic_values(model_of(chain, scene), tool);
}

TEST(Lower, APayloadMayBeAllThatIsLeft) {
  const ir::RobotDescription pendulum = robot("pendulum");
  ir::Scene scene;
  scene.payloads = {"base"};
  scene.cut = {pendulum.links.back().name};
  const Model model = model_of(pendulum, scene);
  expect_generic_values(model, tool);
  const ir::Program program = passes::lower(model.tree, passes::normalise(model.tree, {}), model.scene, {});
  for (const ir::OutputElement& e : program.elements) {  // the text says which phase a value belongs to
    const ir::Node& n = program.graph[e.node];
    EXPECT_TRUE(n.op == ir::Op::constant || n.op == ir::Op::input || n.tag.phase > 0) << e.row;
  }
}

}  // namespace
}  // namespace dalembert
