// Scenes drawn at random: what one output keeps and another overwrites shows where both are asked for, and nobody lists all
// such pairs. DALEMBERT_RANDOM_SCENES=1000 draws so many for each robot. Robots drawn at random too, with joints of every kind:
// DALEMBERT_RANDOM_ROBOTS=10000 draws so many, from seed DALEMBERT_RANDOM_FIRST on; with DALEMBERT_RANDOM_FILES, which names a
// file of one URDF's name a line, their scenes are of these robots in turn. What fails is made smaller as long as it fails, and
// said in words, with its seed.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest-spi.h>

#include <cstdlib>
#include <fstream>
#include <numbers>
#include <random>

#include "both_forms.hpp"
#include "commands/random_states.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/rotation.hpp"
#include "passes/joints_without_mass.hpp"

namespace dalembert {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : engine_(seed) {}
  bool one_in(unsigned n) { return engine_() % n == 0; }
  template <class T>
  const T& of(const std::vector<T>& all) {
    return all[engine_() % all.size()];
  }
  unsigned below(unsigned n) { return static_cast<unsigned>(engine_() % n); }

 private:
  std::mt19937 engine_;
};

// Of what takes no more than the function does.
std::vector<ir::Quantity> quantities(Draw& draw, ir::Function function, const ir::Scene& scene) {
  const unsigned rare = 1 + draw.below(8);
  std::vector<ir::Quantity> some;
  for (const ir::QuantityRow& row : ir::quantities()) {
    if (row.function != ir::Function::evaluate && row.function != function) continue;
    if (row.quantity == ir::Quantity::coriolis_matrix && scene.rates_zero) continue;
    if (!scene.any_constraint() && ir::is_of_constraints(row.quantity)) continue;
    if (draw.one_in(rare)) some.push_back(row.quantity);
  }
  return some;
}

std::vector<ir::LinkOutput> of_links(Draw& draw, const std::vector<std::string>& links) {
  std::vector<ir::LinkOutput> some;
  const std::string& link = draw.of(links);
  const unsigned rare = 1 + draw.below(8);
  for (const ir::LinkQuantityRow& row : ir::link_quantities())
    if (draw.one_in(rare)) some.push_back({row.quantity, draw.one_in(2) ? link : draw.of(links)});
  return some;
}

struct Movable {
  std::vector<std::string> joints, links;
};

// Some joints, one in so many, become others.
void draw_kinds(Draw& draw, const Movable& robot, const std::string& driver, unsigned rare, ir::Scene& scene) {
  for (const std::string& joint : robot.joints) {
    const bool of_one =
        joint == driver || scene.mimic.contains(joint) || scene.elastic.contains(joint) || scene.stiffness.contains(joint);
    if (!draw.one_in(rare)) continue;
    const auto words = ir::joint_words();
    ir::JointKind kind{of_one ? ir::JointType::helical : draw.of(words).second, 0, Eigen::Vector3d(0.36, -0.48, 0.8)};
    if (kind.type == ir::JointType::helical) kind.pitch = draw.one_in(2) ? 0.7 : -2;
    scene.joints[joint] = kind;
  }
}

// Some joints, or all beyond a link; with the base or without; of the regressor and of W some links too.
ir::Part part_of(Draw& draw, const Movable& robot, const ir::Scene& scene, bool of_links) {
  ir::Part part;
  const bool links = of_links && draw.one_in(2);
  if (links)
    for (unsigned i = 1 + draw.below(2); i-- > 0;) part.links.push_back(draw.of(robot.links));
  if (links && draw.one_in(2)) return part;
  if (draw.one_in(2)) part.subtrees.push_back(draw.of(robot.links));
  for (unsigned i = draw.below(4); i-- > 0;) part.joints.push_back(draw.of(robot.joints));
  if (draw.one_in(3) || (part.joints.empty() && part.subtrees.empty()))
    part.base = scene.base == ir::Base::floating && draw.one_in(2);
  return part;
}
void draw_parts(Draw& draw, const Movable& robot, ir::Scene& scene) {
  const auto of_quantities = [&](const std::vector<ir::Quantity>& quantities, std::map<ir::Quantity, ir::Part>& parts) {
    for (const ir::Quantity quantity : quantities)
      if (const ir::Parts has = ir::parts_of(quantity); has.of_joints && !draw.one_in(4))
        parts[quantity] = part_of(draw, robot, scene, has.of_links);
  };
  const auto of_links = [&](std::vector<ir::LinkOutput>& outputs) {
    for (ir::LinkOutput& output : outputs)
      if (const ir::LinkQuantityRow& row = ir::row_of(output.quantity); ir::has_parts(row.rows, row.columns) && !draw.one_in(3))
        output.part = part_of(draw, robot, scene, false);
  };
  of_quantities(scene.outputs, scene.parts);
  of_links(scene.frames);
  for (ir::NamedFunction& function : scene.functions) {
    of_quantities(function.quantities, function.parts);
    of_links(function.of_links);
  }
}

ir::Scene scene_of(Draw& draw, Movable robot) {
  const Movable movable = robot;
  ir::Scene scene;
  if (draw.one_in(3)) {
    scene.placed = {{"sole", draw.of(robot.links), {0.1, -0.2, 0.3}, {0.4, 0, -0.7}},
                    {"heel", draw.of(robot.links), {0, 0, 0.1}, {0, 0, 0}}};
    for (const ir::Frame& frame : scene.placed) robot.links.push_back(frame.name);
  }
  scene.base = draw.one_in(2) ? ir::Base::fixed : ir::Base::floating;
  scene.gravity = {0.7, -1.3, -9.81};
  if (draw.one_in(4)) scene.gravity_kind = ir::GravityKind::run_time;
  if (draw.one_in(6)) scene.gravity_kind = ir::GravityKind::none, scene.gravity.setZero();
  scene.rates_zero = draw.one_in(6);
  if (draw.one_in(3)) scene.coriolis = ir::Coriolis::christoffel;
  if (draw.one_in(3)) scene.forward_dynamics = ir::Solver::factorization;
  for (unsigned i = draw.below(5); i-- > 0;) {
    const std::string& link = draw.of(robot.links);
    const auto type = draw.one_in(3) ? ir::ContactType::weld : ir::ContactType::point;
    const auto held = [&](const ir::Contact& other) { return other.link == link; };
    if (std::any_of(scene.contacts.begin(), scene.contacts.end(), held)) continue;
    const Eigen::Vector3d at(0.1 * (1 + i), -0.07, 0.03 * draw.below(4));
    scene.contacts.push_back({fmt::format("contact {}", i), link, type, at, draw.one_in(3)});
  }
  for (unsigned i = draw.below(3); i-- > 0;) {
    ir::Loop loop;
    loop.name = fmt::format("loop {}", i);
    loop.links = {draw.of(robot.links), draw.of(robot.links)};
    if (loop.links[0] == loop.links[1]) continue;
    loop.type = static_cast<ir::LoopType>(draw.below(7));
    if (loop.type == ir::LoopType::distance) loop.length = 0.4;
    loop.at[0] =
        Eigen::Translation3d(0.1 * (1 + i), 0.2, -0.03) * Eigen::AngleAxisd(0.3 * draw.below(5), Eigen::Vector3d::UnitX());
    loop.at[1] = Eigen::Translation3d(-0.1, 0.05 * draw.below(3), 0.1) * Eigen::AngleAxisd(0.7, Eigen::Vector3d(2, 1, -2) / 3);
    scene.loops.push_back(std::move(loop));
  }
  scene.outputs = quantities(draw, ir::Function::evaluate, scene);
  for (const ir::Function function : {ir::Function::inverse_dynamics, ir::Function::forward_dynamics})
    if (draw.one_in(2))
      for (const ir::Quantity quantity : quantities(draw, function, scene))
        if (ir::row_of(quantity).function == function) scene.outputs.push_back(quantity);
  if (draw.one_in(2)) scene.jacobians.push_back(draw.of(robot.links));
  if (draw.one_in(2))
    for (const ir::LinkOutput& output : of_links(draw, robot.links)) scene.frames.push_back(output);
  for (const char* name : {"one", "other"}) {
    if (!draw.one_in(3)) continue;
    const ir::Function inputs[] = {ir::Function::evaluate, ir::Function::inverse_dynamics, ir::Function::forward_dynamics};
    ir::NamedFunction function{name, quantities(draw, inputs[draw.below(3)], scene), of_links(draw, robot.links)};
    if (!function.quantities.empty() || !function.of_links.empty()) scene.functions.push_back(function);
  }
  const std::string driver = draw.of(robot.joints);
  for (const std::string& joint : robot.joints) {
    const bool driven = joint != driver && draw.one_in(8) && robot.joints.size() > 2;
    if (driven) scene.mimic[joint] = {driver, draw.one_in(2) ? -0.5 : 1.5, 0.2};
    if (draw.one_in(8)) scene.armature[joint] = 0.3;
    if (draw.one_in(8)) scene.damping[joint] = 0.7;
    if (draw.one_in(8)) scene.friction[joint] = 1.1;
    if (!driven && draw.one_in(8)) scene.stiffness[joint] = {3, 0.4};
    if (!driven && draw.one_in(16)) scene.elastic[joint] = {200, 0.5, 0.3};
  }
  if (draw.one_in(4)) scene.payloads.push_back(draw.of(robot.links));
  if (draw.one_in(4)) scene.wrenches.push_back({draw.of(robot.links), draw.one_in(2)});
  if (draw.one_in(3)) draw_kinds(draw, robot, driver, 5, scene);
  if (draw.one_in(3)) draw_parts(draw, movable, scene);
  return scene;
}

// For who has to make it again by hand.
std::string in_words(unsigned seed, const ir::Scene& scene) {
  std::string text =
      fmt::format("scene {}: {} base, gravity {}, statics {}, Christoffel {}, factorization {}", seed,
                  scene.base == ir::Base::fixed ? "fixed" : "floating", static_cast<int>(scene.gravity_kind), scene.rates_zero,
                  scene.coriolis == ir::Coriolis::christoffel, scene.forward_dynamics == ir::Solver::factorization);
  for (const ir::EmittedFunction& function : ir::functions_of(scene)) {
    text += "; " + function.name + ":";
    const auto part_in_words = [](const ir::Part& part) {
      std::string base = !part.base ? "" : *part.base ? "; base" : "; no base";
      return fmt::format(" (joints {}; subtrees {}; links {}{})", fmt::join(part.joints, " "), fmt::join(part.subtrees, " "),
                         fmt::join(part.links, " "), base);
    };
    for (const ir::Quantity quantity : function.quantities) {
      text += fmt::format(" {}", ir::name_of(quantity));
      if (const ir::Part* const part = function.part(quantity)) text += part_in_words(*part);
    }
    for (const ir::LinkOutput& output : function.of_links)
      text += " " + ir::name_of(output) + (output.part ? part_in_words(*output.part) : "");
  }
  const auto add = [&](const char* key, const auto& joints) {
    for (const auto& [joint, value] : joints) text += fmt::format("; {} {}", key, joint);
  };
  add("mimic", scene.mimic);
  add("armature", scene.armature);
  add("damping", scene.damping);
  add("friction", scene.friction);
  add("stiffness", scene.stiffness);
  add("elastic", scene.elastic);
  for (const ir::Frame& frame : scene.placed) text += fmt::format("; frame {} on {}", frame.name, frame.link);
  for (const auto& [joint, kind] : scene.joints)
    for (const auto& [word, type] : ir::joint_words())
      if (type == kind.type) text += fmt::format("; {} {}", word, joint);
  for (const std::string& link : scene.payloads) text += "; payload " + link;
  for (const ir::Contact& contact : scene.contacts)
    text += fmt::format("; {} on {} along {} axes", contact.type == ir::ContactType::weld ? "weld" : "point", contact.link,
                        contact.along_link ? "its" : "the world's");
  for (const ir::Loop& loop : scene.loops)
    text += fmt::format("; loop of type {} between {} and {}", static_cast<int>(loop.type), loop.links[0], loop.links[1]);
  for (const ir::ExternalWrench& wrench : scene.wrenches) text += "; wrench " + wrench.link;
  return text;
}

// Not for the last digits: what is in the wrong place is wrong in the first. Whether something was compared.
bool compare(const ir::RobotDescription& robot, const ir::Scene& scene) {
  try {
    const Model model = model_of(robot, scene);
    // Commands refuse these.
    if (model.tree.nv() == 0) return false;
    passes::check_mass(robot, model.tree, scene);
    const auto of_constraints = [](const Output& output) { return output.quantity && ir::is_of_constraints(*output.quantity); };
    const std::vector<Output> outputs = outputs_of(model);
    if (model.tree.constraint_rows == 0 && std::any_of(outputs.begin(), outputs.end(), of_constraints)) return false;
    expect_generic_values(model, tool, 1000);
    if (model.tree.constraint_rows > 0) {
      SCOPED_TRACE("some constraints off or giving way");
      expect_generic_values(model, tool, 1000, random_acting(model.scene, static_cast<unsigned>(outputs.size())));
    }
    return !outputs_of(model).empty();
  } catch (const InputError&) {
    // The robot refuses the scene: a base without inertia that is to float, or a loop of a body with itself.
    if (scene.loops.empty()) return false;
    ir::Scene without = scene;
    without.loops.clear();
    if (without.contacts.empty()) {  // nothing is left that some outputs are of
      std::erase_if(without.outputs, ir::is_of_constraints);
      for (ir::NamedFunction& function : without.functions) std::erase_if(function.quantities, ir::is_of_constraints);
      std::erase_if(without.functions, [](const ir::NamedFunction& f) { return f.quantities.empty() && f.of_links.empty(); });
    }
    return compare(robot, without);
  }
}

struct Outcome {
  bool compared = false, failed = false;
};
Outcome outcome_of(const ir::RobotDescription& robot, const ir::Scene& scene) {
  testing::TestPartResultArray found;
  Outcome outcome;
  {
    const testing::ScopedFakeTestPartResultReporter reporter(
        testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD, &found);
    outcome.compared = compare(robot, scene);
  }
  for (int i = 0; i < found.size(); ++i) outcome.failed = outcome.failed || found.GetTestPartResult(i).failed();
  return outcome;
}
bool fails(const ir::RobotDescription& robot, const ir::Scene& scene) { return outcome_of(robot, scene).failed; }

// One entry less of one of the scene's lists or maps after another, as long as what is left fails.
ir::Scene smaller(const ir::RobotDescription& robot, ir::Scene scene) {
  const auto shrink = [&](auto of) {
    for (size_t i = 0; i < of(scene).size();) {
      ir::Scene less = scene;
      of(less).erase(std::next(of(less).begin(), static_cast<std::ptrdiff_t>(i)));
      if (fails(robot, less)) scene = less;
      else ++i;
    }
  };
  for (size_t before = 0, after = 1; before != after;) {
    const auto size = [&] { return in_words(0, scene).size(); };
    before = size();
    shrink([](ir::Scene & s) -> auto& { return s.functions; });
    shrink([](ir::Scene & s) -> auto& { return s.outputs; });
    shrink([](ir::Scene & s) -> auto& { return s.frames; });
    shrink([](ir::Scene & s) -> auto& { return s.parts; });
    shrink([](ir::Scene & s) -> auto& { return s.jacobians; });
    shrink([](ir::Scene & s) -> auto& { return s.contacts; });
    shrink([](ir::Scene & s) -> auto& { return s.wrenches; });
    shrink([](ir::Scene & s) -> auto& { return s.payloads; });
    shrink([](ir::Scene & s) -> auto& { return s.joints; });
    shrink([](ir::Scene & s) -> auto& { return s.mimic; });
    shrink([](ir::Scene & s) -> auto& { return s.elastic; });
    shrink([](ir::Scene & s) -> auto& { return s.stiffness; });
    shrink([](ir::Scene & s) -> auto& { return s.friction; });
    shrink([](ir::Scene & s) -> auto& { return s.damping; });
    shrink([](ir::Scene & s) -> auto& { return s.armature; });
    after = size();
  }
  return scene;
}

// Joints locked one after another as long as what is left fails.
ir::RobotDescription smaller_robot(ir::RobotDescription robot, const ir::Scene& scene) {
  for (ir::Joint& joint : robot.joints) {
    const auto named = [&](const auto& map) { return map.contains(joint.name); };
    bool driver = false;
    for (const auto& [driven, relation] : scene.mimic) driver = driver || relation.of == joint.name;
    if (driver || named(scene.joints) || named(scene.mimic) || named(scene.elastic) || named(scene.stiffness) ||
        named(scene.friction) || named(scene.damping) || named(scene.armature))
      continue;
    const ir::JointType type = joint.type;
    joint.type = ir::JointType::fixed;
    if (!fails(robot, scene)) joint.type = type;
  }
  return robot;
}

// Links and joints from light to none, axes along the frame's or askew, branches of equal and unequal length. Every tip has a
// mass. Half of the robots are tidy: quarters of turns, axes along the frame's, centres of mass at the origin: elements of
// theirs are constants, which the others' never are.
ir::RobotDescription random_robot(Draw& draw) {
  ir::RobotDescription robot;
  robot.name = robot.file = "random";
  robot.root = 0;
  const auto number = [&] { return (static_cast<double>(draw.below(2001)) - 1000) / 1000; };
  const bool tidy = draw.one_in(2);
  const auto some = [&](double size) { return draw.one_in(3) ? 0.0 : size * number(); };
  const auto turn = [&](double size) {
    return !tidy ? some(size) : draw.one_in(4) ? 0.5 * std::numbers::pi * (static_cast<double>(draw.below(4)) - 1) : 0.0;
  };
  const auto shift = [&](double size) { return tidy ? 0.0 : some(size); };
  const int joints = 1 + static_cast<int>(draw.below(12));
  robot.children.resize(static_cast<size_t>(joints) + 1);
  for (int i = 0; i < joints; ++i) {
    ir::Joint joint;
    joint.name = fmt::format("j{:02}", i);
    joint.parent = draw.one_in(3) ? static_cast<int>(draw.below(static_cast<unsigned>(i) + 1)) : i;
    joint.child = i + 1;
    joint.origin.translation() << some(0.4), some(0.4), some(0.4);
    joint.origin.linear() = ir::rotation_from_rpy({turn(3), turn(1.5), turn(3)});
    joint.axis = Eigen::Vector3d::Unit(static_cast<int>(draw.below(3)));
    if (!tidy && draw.one_in(3)) joint.axis = Eigen::Vector3d(number(), number(), 1.1).normalized();
    const std::vector<ir::JointType> types = {ir::JointType::revolute, ir::JointType::continuous, ir::JointType::prismatic,
                                              ir::JointType::revolute, ir::JointType::planar,     ir::JointType::floating,
                                              ir::JointType::revolute, ir::JointType::fixed};
    joint.type = i == 0 ? ir::JointType::revolute : draw.of(types);
    robot.children[static_cast<size_t>(joint.parent)].push_back(i);
    robot.joints.push_back(joint);
  }
  for (int i = 0; i <= joints; ++i) {
    ir::Link link;
    link.name = fmt::format("l{:02}", i);
    const bool tip = robot.children[static_cast<size_t>(i)].empty();
    const double mass = draw.one_in(6) ? 0.01 : 1 + 0.9 * number();
    const Eigen::Vector3d central = mass * (tidy && draw.one_in(2) ? Eigen::Vector3d(0.02, 0.02, 0.02)
                                                                   : Eigen::Vector3d(0.02, 0.03 + 0.005 * number(), 0.025));
    if (tip || i == 0 || !draw.one_in(5))
      link.inertia = ir::Inertia{mass,
                                 {shift(0.2), shift(0.2), shift(0.2)},
                                 ir::rotated(central.asDiagonal(), ir::rotation_from_rpy({shift(1), shift(1), shift(1)}))};
    robot.links.push_back(link);
  }
  return robot;
}

Movable movable_of(const ir::RobotDescription& robot) {
  Movable movable;
  for (const ir::Joint& joint : robot.joints) {
    movable.links.push_back(robot.links[static_cast<size_t>(joint.child)].name);
    // What has several coordinates of its own takes part in no relation and no spring.
    if (ir::coordinates_of(joint.type) == 1) movable.joints.push_back(joint.name);
  }
  return movable;
}

// Whether the case was compared; where it fails, it is said again, smaller.
bool try_case(const ir::RobotDescription& robot, unsigned seed, const ir::Scene& scene) {
  if (const Outcome outcome = outcome_of(robot, scene); !outcome.failed) return outcome.compared;
  const ir::Scene least = smaller(robot, scene);
  const ir::RobotDescription fewest = smaller_robot(robot, least);
  std::string joints;
  for (const ir::Joint& joint : fewest.joints)
    if (joint.type != ir::JointType::fixed) joints += " " + joint.name;
  SCOPED_TRACE(fmt::format("{}\nmade smaller: {}\njoints that move:{}", in_words(seed, scene), in_words(seed, least), joints));
  compare(fewest, least);
  return true;
}

// Of DALEMBERT_RANDOM_FILES.
std::vector<std::string> files_of_ones_own() {
  std::vector<std::string> files;
  const char* const list = std::getenv("DALEMBERT_RANDOM_FILES");
  if (!list) return files;
  std::ifstream lines(list);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) files.push_back(line);
  EXPECT_FALSE(files.empty()) << "DALEMBERT_RANDOM_FILES=" << list << " names no file of names";
  return files;
}

TEST(RandomRobots, AreWhatTheGenericEngineComputes) {
  const char* const asked_for = std::getenv("DALEMBERT_RANDOM_ROBOTS");
  const unsigned robots = asked_for ? static_cast<unsigned>(std::atoi(asked_for)) : 150;
  ASSERT_GT(robots, 0u) << "DALEMBERT_RANDOM_ROBOTS=" << asked_for << " is no number of robots";
  const char* const from = std::getenv("DALEMBERT_RANDOM_FIRST");
  const unsigned first = from ? static_cast<unsigned>(std::atoi(from)) : 0;
  const std::vector<std::string> files = files_of_ones_own();
  unsigned compared = 0;
  const auto failures = [&] { return testing::UnitTest::GetInstance()->current_test_info()->result()->total_part_count(); };
  for (unsigned seed = first; seed < first + robots && failures() < 12; ++seed) {
    Draw draw(seed);
    Diagnostics warnings;
    const ir::RobotDescription robot =
        files.empty() ? random_robot(draw) : frontend::read_urdf(files[seed % files.size()], warnings);
    SCOPED_TRACE(robot.file);
    const Movable movable = movable_of(robot);
    if (movable.joints.empty()) continue;
    compared += try_case(robot, seed, scene_of(draw, movable));
  }
  EXPECT_GE(compared, robots / 2) << "of " << robots << " robots; the others refuse their scenes";
}

// R2D2's gripper with a spring in a finger: what hung on the pole was in a column of constants, and added once more.
TEST(FoundAtRandom, WhatIsKnownBelowIsNotHandedOnToo) {
  const auto link = [](const char* name) {
    return fmt::format(
        "<link name='{}'><inertial><origin xyz='0 0 0'/><mass value='2'/>"
        "<inertia ixx='0.1' ixy='0' ixz='0' iyy='0.15' iyz='0' izz='0.2'/></inertial></link>",
        name);
  };
  const auto joint = [](const char* name, const char* type, const char* parent, const char* child, const char* axis) {
    return fmt::format(
        "<joint name='{}' type='{}'><parent link='{}'/><child link='{}'/><origin xyz='0 0 0.2'/><axis xyz='{}'/>"
        "<limit lower='-1' upper='1' effort='1' velocity='1'/></joint>",
        name, type, parent, child, axis);
  };
  std::string text = "<robot name='gripper'>";
  for (const char* name : {"base", "pole", "left", "right", "one", "two", "three", "four"}) text += link(name);
  for (const char* wheel : {"one", "two", "three", "four"}) text += joint(wheel, "continuous", "base", wheel, "1 0 0");
  text += joint("extend", "prismatic", "base", "pole", "1 0 0");
  text += joint("left_joint", "continuous", "pole", "left", "0 1 0");
  text += joint("right_joint", "continuous", "pole", "right", "0 1 0") + "</robot>";
  Diagnostics warnings;
  const ir::RobotDescription gripper = frontend::read_urdf_text("gripper.urdf", text, warnings);
  for (const ir::Base base : {ir::Base::fixed, ir::Base::floating}) {
    ir::Scene scene;
    scene.base = base;
    scene.elastic["left_joint"] = {200, 0.5, 0.3};
    scene.outputs = {ir::Quantity::mass_matrix, ir::Quantity::coriolis_matrix, ir::Quantity::bias,
                     ir::Quantity::forward_dynamics};
    expect_generic_values(model_of(gripper, scene));
  }
}

class RandomScenes : public testing::TestWithParam<TestRobot> {};

TEST_P(RandomScenes, AreWhatTheGenericEngineComputes) {
  const char* const asked_for = std::getenv("DALEMBERT_RANDOM_SCENES");
  const ir::RobotDescription description = robot(GetParam().name);
  const Movable movable = movable_of(description);
  const unsigned scenes = asked_for ? static_cast<unsigned>(std::atoi(asked_for)) : 8;
  ASSERT_GT(scenes, 0u) << "DALEMBERT_RANDOM_SCENES=" << asked_for << " is no number of scenes";
  unsigned compared = 0;
  for (unsigned seed = 0; seed < scenes; ++seed) {
    Draw draw(seed);
    const ir::Scene scene = scene_of(draw, movable);
    compared += try_case(description, seed, scene);
    if (HasFailure()) return;
  }
  // Almost all of the first 12 with each of the robots; fewer where a scene without its loops asks for constraints.
  EXPECT_GE(compared, scenes / 2) << "of " << scenes << " scenes; the others are refused";
}

INSTANTIATE_TEST_SUITE_P(Robots, RandomScenes, testing::ValuesIn(test_robots),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace dalembert
