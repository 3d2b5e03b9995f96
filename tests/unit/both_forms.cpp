#include "both_forms.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "commands/generic_engine.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/coordinate_tree.hpp"
#include "passes/build_tree.hpp"
#include "passes/combine_inertia.hpp"
#include "passes/embedding.hpp"
#include "passes/normalise.hpp"
#include "passes/part_of_tree.hpp"
#include "passes/plan.hpp"
#include "passes/project_by_rows.hpp"
#include "passes/quantities/quantities.hpp"
#include "passes/reference.hpp"
#include "passes/resolve_parts.hpp"
#include "passes/roll.hpp"
#include "passes/unroll.hpp"
#include "passes/write_out.hpp"
#include "reference/engine.hpp"

namespace dalembert {

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
  passes::resolve_parts(model.scene, model.tree);
  return model;
}

State some_state(const ir::KinematicTree& tree) {
  State state{"", Eigen::VectorXd(tree.nq()), Eigen::VectorXd(tree.nv()), Eigen::VectorXd(tree.nv()),
              Eigen::VectorXd(6 * static_cast<Eigen::Index>(tree.pushed.size()))};
  for (Eigen::Index i = 0; i < state.wrenches.size(); ++i) state.wrenches[i] = 3 * std::cos(0.4 + 2.3 * static_cast<double>(i));
  for (int i = 0; i < tree.nq(); ++i) state.q[i] = std::sin(1.0 + 1.7 * i);
  for (int i = 0; i < tree.nv(); ++i) state.v[i] = std::cos(2.0 + 1.3 * i);
  for (int i = 0; i < tree.nv(); ++i) state.more[i] = std::cos(1.0 + 1.9 * i);
  for (const int first : tree.quaternions()) state.q.segment<4>(first).normalize();
  if (!tree.linkages.empty()) ir::draw_closed(tree, state.q, 400, 0.1, true);
  return state;
}

std::string link_moved_by(const ir::RobotDescription& robot, const std::string& name) {
  for (const ir::Joint& joint : robot.joints)
    if (joint.name == name) return robot.links[static_cast<size_t>(joint.child)].name;
  throw std::invalid_argument(name);
}

std::vector<ir::Contact> some_contacts(const ir::RobotDescription& robot) {
  std::vector<std::string> moved;
  for (const ir::Joint& joint : robot.joints)
    if (joint.type != ir::JointType::fixed) moved.push_back(robot.links[static_cast<size_t>(joint.child)].name);
  std::vector<ir::Contact> contacts;
  if (!moved.empty()) contacts.push_back({"foot", moved.back(), ir::ContactType::weld, {0.1, -0.2, 0.05}, false});
  if (moved.size() > 6) contacts.push_back({"toe", moved[moved.size() / 2], ir::ContactType::point, {0.02, 0.1, -0.3}, true});
  if (moved.size() > 9) contacts.push_back({"knee", moved[moved.size() / 3], ir::ContactType::point, {-0.1, 0, 0.07}, false});
  return contacts;
}

std::vector<ir::Loop> some_loops(const ir::RobotDescription& robot) {
  std::vector<std::string> moved;
  for (const ir::Joint& joint : robot.joints)
    if (joint.type != ir::JointType::fixed) moved.push_back(robot.links[static_cast<size_t>(joint.child)].name);
  std::vector<ir::Loop> loops;
  const auto pose = [](double x, double angle) {
    Eigen::Isometry3d at = Eigen::Translation3d(x, 0.1, -0.2) * Eigen::AngleAxisd(angle, Eigen::Vector3d(1, 2, -2) / 3);
    return at;
  };
  const std::string& base = robot.links[static_cast<size_t>(robot.root)].name;
  if (moved.size() > 2)
    loops.push_back({"rod", {moved.front(), moved.back()}, {pose(0.1, 0.4), pose(-0.2, 1)}, ir::LoopType::distance, {}});
  if (moved.size() > 4)
    loops.push_back({"knee", {moved[1], moved.back()}, {pose(0, -0.3), pose(0.3, 2)}, ir::LoopType::hinge, {}});
  if (moved.size() > 6)
    loops.push_back({"hip", {moved[moved.size() / 2], base}, {pose(0.2, 0), pose(0, 0.7)}, ir::LoopType::cylinder, {}});
  if (moved.size() > 12)
    loops.push_back({"arm", {moved[moved.size() / 3], moved[2]}, {pose(0.2, 0.1), pose(-0.1, 0.7)}, ir::LoopType::pin, {}});
  return loops;
}

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

namespace {

// Lines go by the frames of bodies so many joints up each branch of a fixed base, as many as may be; on every fourth robot by
// those of the first.
std::vector<int> some_references(const ir::Algorithm& algorithm, const ir::KinematicTree& tree, const ir::NormalTree& normal) {
  const auto cost = [&](const std::vector<int>& bodies) {
    double sum = 0;
    for (const int body : bodies) {
      int above = 0;
      for (int at = body; (at = tree.bodies[static_cast<size_t>(at)].parent) >= 0;) ++above;
      sum -= above > tree.joints() % 4 ? 0 : above;
    }
    return sum;
  };
  return passes::reference_bodies(algorithm, tree, normal, cost);
}

// What a contact or loop is given.
double of_constraint(const ir::Input& in, const ir::Scene& scene, const ir::Acting& acting, const Gains& gains) {
  const auto c = static_cast<size_t>(in.index);
  const bool active = acting.active.empty() || acting.active[c];
  if (in.component == ir::contact_active) return active ? 1 : 0;
  const std::vector<ir::Constraint> all = scene.constraints();
  const int row = in.component - (all[c].loop ? ir::loop_rows : ir::contact_rows);
  if (row >= 0) {
    int first = 0;
    for (size_t before = 0; before < c; ++before) first += all[before].rows;
    const bool is_weight = row >= all[c].rows;
    const Eigen::VectorXd& given = is_weight ? acting.weights : acting.regularization;
    if (!active) return 0;
    return given.size() > 0 ? given[first + row % all[c].rows] : is_weight ? 1 : 0;
  }
  if (in.component >= ir::contact_anchor) return gains.anchor[in.component - ir::contact_anchor];
  if (in.component == ir::contact_restitution) return acting.restitution.empty() ? 0.0 : acting.restitution[c];
  return in.component == ir::contact_kp ? gains.kp : gains.kd;
}

// What a section takes: `left` by those before it.
ir::FunctionInput input_of(const ir::Algorithm& algorithm, const Model& model, const State& state, const Payload& payload,
                           const Gains& gains, const ir::Arrays& left) {
  return [&](const ir::Input& in) {
    const auto array = [&](int index) { return left.at(algorithm.arrays[static_cast<size_t>(index)].name); };
    switch (in.kind) {
      case ir::InputKind::position: return state.q[in.index];
      case ir::InputKind::velocity: return state.v[in.index];
      case ir::InputKind::acceleration:
      case ir::InputKind::effort: {
        const int accelerations = algorithm.section.accelerations;
        return accelerations < 0 ? state.more[in.index] : array(accelerations)(in.index, 0);
      }
      case ir::InputKind::gravity: return model.scene.gravity[in.component];
      case ir::InputKind::wrench: return state.wrenches[6 * in.index + in.component];
      case ir::InputKind::constraint: return of_constraint(in, model.scene, state.acting, gains);
      case ir::InputKind::element: return array(in.index)(in.component);
      case ir::InputKind::payload: return payload[static_cast<size_t>(in.component)];
      default: return std::nan("");
    }
  };
}

passes::Unroll line_by_frames(const ir::Algorithm& line, const ir::KinematicTree& tree, const ir::NormalTree& normal,
                              const ir::Scene& scene) {
  return {line, tree, normal, scene, {{}, false, false, ir::Elements::kept, some_references(line, tree, normal)}};
}

// One section behind what those before left.
std::array<ir::Arrays, 2> run_section(const ir::Algorithm& algorithm, const ir::Algorithm& line_of, bool only,
                                      const ir::KinematicTree& tree, const ir::NormalTree& normal, const Model& model,
                                      const State& state, const Payload& payload, const std::array<ir::Arrays, 2>& left,
                                      const Gains& gains) {
  const auto input = [&](size_t form) { return input_of(algorithm, model, state, payload, gains, left[form]); };
  passes::Unroll unroll(algorithm, tree, normal, model.scene, {{}, false});
  ir::Algorithm written_out = line_of;
  passes::Unroll by_frames = line_by_frames(line_of, tree, normal, model.scene);
  ir::Program line = by_frames.take_program();
  // On half of the robots the line is that of batches.
  const bool whole =
      only && tree.nv() % 2 == 0 && passes::write_out_kernels(written_out, line, ir::coordinate_tree(tree), true);
  if (!whole) passes::project_by_rows(written_out, line, by_frames, tree);
  if (only && !whole) passes::write_out_kernels(written_out, line, ir::coordinate_tree(tree));
  ir::Arrays straight = ir::run(written_out, line, tree, input(0), left[0], state.acting);
  if (tree.bodies.empty()) return {straight, straight};  // a base alone
  ir::CompileOptions options;
  options.write_limbs = tree.joints() % 2 == 0;  // loops over a limb alone on half of the robots, written out on the others
  const ir::Plan plan = passes::plan(tree, model.scene, ir::Form::rolled, options, passes::rows_in_pairs(algorithm, tree));
  const ir::RolledProgram program = passes::roll(algorithm, unroll, tree, model.scene, plan, {});
  return {straight, ir::run(algorithm, program, plan, tree, model.scene.rates_zero, input(1), left[1], state.acting)};
}

// All sections as one line, as batches have them. None where there is no such line.
std::optional<ir::Arrays> run_joined(std::vector<ir::Algorithm> lines, const ir::KinematicTree& tree,
                                     const ir::NormalTree& normal, const Model& model, const State& state,
                                     const Payload& payload, const Gains& gains) {
  std::vector<ir::Program> programs;
  std::vector<passes::SectionBehind> behind;
  for (const ir::Algorithm& line : lines) programs.push_back(line_by_frames(line, tree, normal, model.scene).take_program());
  for (size_t i = 1; i < lines.size(); ++i) behind.push_back({lines[i], programs[i]});
  if (!passes::write_out_kernels(lines[0], programs[0], ir::coordinate_tree(tree), true, behind)) return {};
  const ir::FunctionInput input = input_of(lines[0], model, state, payload, gains, {});
  return ir::run(lines[0], programs[0], tree, input, {}, state.acting);
}

}  // namespace

Following following(const ir::KinematicTree& tree, const State& state) {
  const ir::Followers list = ir::followers(tree);
  const auto count = static_cast<Eigen::Index>(list.elements.size());
  Eigen::VectorXd G = Eigen::VectorXd::Zero(count), G_rate = G;
  Following f{Eigen::MatrixXd::Zero(list.all, tree.nv()), Eigen::MatrixXd::Zero(list.all, tree.nv()), {}};
  Eigen::Index first = 0;
  for (size_t i = 0; i < tree.linkages.size(); ++i) {
    ir::EvaluatedRows rows(tree.linkages[i], tree);
    follow(rows, static_cast<int>(i), state.q.data(), state.v.data(), G.data() + first, G_rate.data() + first, f.status);
    first += rows.dependent * rows.independent;
  }
  for (int i = 0; i < tree.nv(); ++i) f.T(list.at[static_cast<size_t>(i)], i) = 1;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Follower& element = list.elements[static_cast<size_t>(i)];
    f.T(element.coordinate, element.follows) += G[i];
    f.T_rate(element.coordinate, element.follows) += G_rate[i];
  }
  return f;
}

namespace {

// The function on the tree without embedded loops, in both forms, and what becomes of it with T and T' as dense matrices.
std::array<ir::Arrays, 2> run_embedded(const ir::EmittedFunction& function, const Model& model, const State& state,
                                       const Payload& payload) {
  const passes::EmbeddedFunction embedded = passes::embed(function, model.tree, model.scene);
  const ir::Embedding& e = *embedded.algorithm.embedding;
  Model opened = model;
  opened.tree = model.tree.opened();
  opened.scene = passes::opened(model.scene);
  State moving = state;
  if (model.scene.rates_zero) moving.v.setZero();
  const Following f = following(model.tree, moving);
  const Eigen::VectorXd turning = f.T_rate * moving.v;
  moving.more = turning;
  if (e.of_input) moving.more += f.T * state.more;
  moving.v = f.T * Eigen::VectorXd(moving.v);
  const std::array<ir::Arrays, 2> whole = run_function(embedded.of_opened, opened, moving, payload);
  std::array<ir::Arrays, 2> results;
  for (size_t form : {0u, 1u}) {
    ir::Arrays& arrays = results[form];
    for (const ir::OutputArray& a : embedded.algorithm.arrays) arrays[a.name] = Eigen::MatrixXd::Zero(a.rows, a.columns);
    for (const ir::Projected& p : e.projected) {
      Eigen::MatrixXd& to = arrays.at(embedded.algorithm.arrays[static_cast<size_t>(p.to)].name);
      const Eigen::MatrixXd& from = whole[form].at(p.from);
      const auto more = [&] { return whole[form].at(p.more); };
      using Kind = ir::Projected::Kind;
      switch (p.kind) {
        case Kind::same: to = from; break;
        case Kind::columns: to = from * f.T; break;
        case Kind::rows: to = f.T.transpose() * from; break;
        case Kind::both: to = f.T.transpose() * from * f.T; break;
        case Kind::both_turned: to = f.T.transpose() * (from * f.T + more() * f.T_rate); break;
        case Kind::turned: to = from + more() * turning; break;
        case Kind::rows_of_turned: to = f.T.transpose() * (from + more() * turning); break;
        case Kind::unbalanced: to = state.more - f.T.transpose() * from; break;
      }
    }
    arrays = ir::run(
        embedded.algorithm, ir::Program(), model.tree, [](const ir::Input&) { return std::nan(""); }, arrays);
  }
  return results;
}

}  // namespace

std::array<ir::Arrays, 2> run_function(const ir::EmittedFunction& function, const Model& model, const State& state,
                                       const Payload& payload, const Gains& gains, std::optional<ir::Solver> solver) {
  if (!model.tree.linkages.empty()) return run_embedded(function, model, state, payload);
  const std::optional<ir::KinematicTree> part = passes::part_of_tree(function, model.tree, model.scene);
  const ir::KinematicTree& tree = part ? *part : model.tree;
  const ir::NormalTree normal = passes::normalise(tree, passes::normalise_options(model.scene, true));
  if (!solver) solver = passes::solvers(function, tree, model.scene).front();
  const std::vector<ir::Algorithm> sections = passes::describe(function, tree, normal, model.scene, *solver, {});
  const std::vector<ir::Algorithm> lines = passes::describe(function, tree, normal, model.scene, *solver, {}, {false, true});
  std::array<ir::Arrays, 2> results;
  for (size_t i = 0; i < sections.size(); ++i)
    results = run_section(sections[i], lines.at(i), sections.size() == 1, tree, normal, model, state, payload, results, gains);
  // On half of the robots the line is that of batches.
  if (sections.size() > 1 && tree.nv() % 2 == 0)
    if (const auto joined = run_joined(lines, tree, normal, model, state, payload, gains)) results[0] = *joined;
  return results;
}

std::array<ir::Arrays, 2> run_both(const Model& model, const State& state, const Payload& payload) {
  std::array<ir::Arrays, 2> results;
  for (const ir::EmittedFunction& function : ir::functions_of(model.scene)) {
    std::array<ir::Arrays, 2> own = run_function(function, model, state, payload);
    for (size_t form : {0u, 1u}) results[form].merge(own[form]);
  }
  return results;
}

void expect_generic_values(const Model& model, const Payload& payload, double slack, const ir::Acting& acting) {
  Model expected = model;
  for (const std::string& link : model.scene.payloads) expected.tree = welded(expected.tree, link, payload);
  State state = some_state(model.tree);
  state.acting = acting;
  const auto [straight, rolled] = run_both(model, state, payload);
  for (const Output& output : outputs_of(model)) {
    SCOPED_TRACE(output.name);
    const Eigen::MatrixXd reference = evaluate_generic(expected, output, state);
    const reference::Inputs inputs = dalembert::inputs(state);
    const double condition =
        reference::condition({output.quantity, output.link, output.of_link}, expected.tree, expected.scene, inputs);
    const auto tolerance_of = [&](double scale) { return slack * scale * std::max(1e-12, 10 * 0x1p-53 * condition); };
    const auto error_of = [&](const ir::Arrays& arrays) {
      return (arrays.at(output.name) - reference).cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    };
    // Where a robot makes a quantity vanish, rounding of larger terms is left: what these are is asked for where it matters.
    double tolerance = tolerance_of(std::max(reference.cwiseAbs().maxCoeff(), 1e-3));
    const double errors[] = {error_of(straight), error_of(rolled)};
    if (!(std::max(errors[0], errors[1]) <= tolerance))
      tolerance = std::max(
          tolerance,
          tolerance_of(
              reference::LeastScale(expected.tree, expected.scene, inputs).of({output.quantity, output.link, output.of_link})));
    EXPECT_LE(errors[0], tolerance) << "straight; condition " << condition;
    EXPECT_LE(errors[1], tolerance) << "rolled; condition " << condition;
  }
}

}  // namespace dalembert
