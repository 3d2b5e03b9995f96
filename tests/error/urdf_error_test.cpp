// One URDF per defect in this folder, each with what the user reads about it, word for word.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "run_dalembert.hpp"

namespace dalembert::test {
namespace {

struct Case {
  const char* robot;     // file in this folder, without .urdf
  const char* messages;  // lines of stderr, without the file's name in front
};

// The same in a scene.
struct Use {
  const char* name;
  const char* robot;
  std::vector<std::string> options;
  int status;
  const char* messages;
  const char* output;  // what `info` says then
};

void PrintTo(const Case& c, std::ostream* os) { *os << c.robot; }
void PrintTo(const Use& use, std::ostream* os) { *os << use.name; }
std::string name_of(const testing::TestParamInfo<Case>& info) { return info.param.robot; }

// Every line of the messages with the file's name in front.
std::string expected(const Case& c) {
  const std::string prefix = std::string(c.robot) + ".urdf: ";
  std::string text = prefix;
  for (const char* at = c.messages; *at; ++at) text += *at == '\n' ? "\n" + prefix : std::string(1, *at);
  return text + "\n";
}

// What is said of a base that nobody says anything of, and all else.
struct Said {
  std::string notices, all_else;
};

Said said(const std::string& err) {
  Said said;
  std::istringstream lines(err);
  for (std::string line; std::getline(lines, line);)
    (line.find(": notice: ") == line.npos ? said.all_else : said.notices) += line + "\n";
  return said;
}

// Robots of which a joint says whether the base moves: a floating one, or one on the world.
bool says_of_its_base(const std::string& robot) {
  return robot.starts_with("floating_root") || robot == "implicit_world" || robot == "coaxial_joints";
}

// clang-format off
const Case defects[] = {
    {"axis_between_tags",
     "joint 'j' (line 17): error: <axis> has <xyz> between its tags, where nothing is read; write <axis xyz=\"...\"/>"},
    {"axis_without_xyz",
     "joint 'j' (line 17): error: <axis> has no xyz; write <axis xyz=\"0 0 1\"/> or another direction"},
    {"beside_robot",
     "<link> (line 21): error: it stands outside of <robot>; move it into <robot>, or remove it"},
    {"blank_mass",
     "link 'b' (line 10): error: <mass value=\" \"> is not a number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"blank_moment",
     "link 'b' (line 11): error: <inertia ixx=\"\"> is not a number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"cancelling_masses",
     "body 'b': error: the masses of its links cancel: there is no centre of mass; negative is that of link 'c' (line 14); give these links a mass of zero or more"},
    {"commas_between_numbers",
     "joint 'j' (line 17): error: <axis xyz=\"0, 0, 1\"> is not three finite numbers; write three finite decimal numbers with blanks between them"},
    {"cycle_beside_tree",
     "joint 'l' (line 36): error: the joints form a cycle: each link's parent is the next of c, d, c; remove one joint of the cycle, so that one root link remains"},
    {"cycle_without_root",
     "joint 'k' (line 19): error: the joints form a cycle: each link's parent is the next of a, b, a; remove one joint of the cycle, so that one root link remains"},
    {"duplicate_joint",
     "joint 'j' (line 25): error: the name is already taken by the joint of line 20; rename one of them"},
    {"duplicate_link",
     "link 'b' (line 14): error: the name is already taken by the link of line 8; rename one of them"},
    {"doctype_entities",
     "<!DOCTYPE>: error: declarations inside of it cannot be read; remove them, or have xmllint --noent put in what their entities stand for"},
    {"empty",
     "error: the file is empty; name a URDF file"},
    {"float_suffix",
     "link 'b' (line 10): error: <mass value=\"1e-3f\"> is not a number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"four_numbers",
     "joint 'j' (line 17): error: <origin xyz=\"0 0 1 0\"> is not three finite numbers; write three finite decimal numbers with blanks between them"},
    {"hexadecimal_mass",
     "link 'b' (line 10): error: <mass value=\"0x10\"> is not a number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"indefinite_inertia",
     "link 'b' (line 8): error: the inertia is not positive definite (principal moments -1, 1, 3 kg m²); correct <inertia>: its matrix about the centre of mass has no negative principal moment; or go on knowingly with inertia: accept or inertia: repair in the scene"},
    {"inertia_between_tags",
     "link 'b' (line 11): error: <inertia> has <ixx> between its tags, where nothing is read; write <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m²"},
    {"infinite_mass",
     "link 'b' (line 10): error: <mass value=\"inf\"> is not a finite number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"infinite_rpy",
     "joint 'j' (line 18): error: <origin rpy=\"0 0 -inf\"> is not three finite numbers; write three finite decimal numbers with blanks between them"},
    {"joint_to_itself",
     "joint 'k' (line 19): error: the joint connects link 'b' to itself; name two different links"},
    {"malformed_axis",
     "joint 'j' (line 17): error: <axis xyz=\"0 1\"> is not three finite numbers; write three finite decimal numbers with blanks between them"},
    {"malformed_mass",
     "link 'b' (line 10): error: <mass value=\"1,5\"> is not a number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"malformed_xml",
     "line 3, column 1: error: this is not well-formed XML: Error reading end tag.; close the tag or quote opened there"},
    {"losses_between_tags",
     "joint 'j' (line 19): warning: <mimic> has 'a remark that is longer than what is sho...' between its tags, where nothing is read; remove it\n"
     "joint 'j' (line 18): error: <dynamics> has <damping> between its tags, where nothing is read; write <dynamics damping=\"...\" friction=\"...\"/>"},
    {"mass_between_tags",
     "link 'b' (line 10): error: <mass> has '1' between its tags, where nothing is read; write <mass value=\"...\"/> in kg"},
    {"misspelt_joint_type",
     "joint 'j' (line 14): error: joints of type 'hinge' are not supported; use revolute, continuous, prismatic, planar, floating or fixed"},
    {"nan_axis",
     "joint 'j' (line 17): error: <axis xyz=\"0 nan 1\"> is not three finite numbers; write three finite decimal numbers with blanks between them"},
    {"nan_inertia",
     "link 'b' (line 11): error: <inertia iyy=\"nan\"> is not a finite number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"nan_origin",
     "link 'b' (line 10): error: <origin xyz=\"nan 0 0\"> is not three finite numbers; write three finite decimal numbers with blanks between them"},
    {"negative_behind_joint",
     "link 'c' (line 14): error: the inertia is not positive definite (principal moments -0.015, 1, 1 kg m²); correct <inertia>: its matrix about the centre of mass has no negative principal moment; or go on knowingly with inertia: accept or inertia: repair in the scene"},
    {"negative_inertia",
     "link 'b' (line 8): error: the inertia is not positive definite (principal moments -1, 1, 1 kg m²); correct <inertia>: its matrix about the centre of mass has no negative principal moment; or go on knowingly with inertia: accept or inertia: repair in the scene"},
    {"negative_mass",
     "link 'b' (line 8): error: the mass is negative (-1 kg); give the link a mass of zero or more, or go on knowingly with inertia: accept in the scene"},
    {"no_child",
     "joint 'j' (line 14): error: the joint has no <child>; add <child link=\"...\"/>"},
    {"no_joint_type",
     "joint 'j' (line 14): error: <joint> has no type; write type=\"revolute\", continuous, prismatic, planar, floating or fixed"},
    {"no_link_name",
     "link number 2 (line 8): error: <link> has no name; write <link name=\"...\">\n"
     "link number 3 (line 19): error: <link> has no name; write <link name=\"...\">"},
    {"no_links",
     "robot 'r': error: there are no links; add at least one <link>"},
    {"no_mass_at_all",
     "link 'a' (line 3): warning: <inertial> has no <inertia>: zeros are taken; add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m² (the first of 2 such warnings; --verbose shows all)\n"
     "robot 'r': error: nothing that moves has a mass: there are no dynamics; give the links <inertial> with a mass, or ask for what needs none: --outputs wrench_influence, or --outputs '' --jacobians LINK"},
    {"no_parent",
     "joint 'j' (line 14): error: the joint has no <parent>; add <parent link=\"...\"/>"},
    {"no_parent_link",
     "joint 'j' (line 15): error: <parent> has no link; add <parent link=\"...\"/>"},
    {"no_robot",
     "<sdf> (line 1): error: there is no <robot> element; call an SDF .sdf; where xacro prints it, expand it first: xacro FILE > robot.sdf"},
    {"not_xml",
     "error: this is not XML; a URDF is an XML file whose root is <robot>"},
    {"nothing_moves",
     "robot 'r': error: no joint is left to move and the base is fixed; give it a joint that moves, or ask for --base floating"},
    {"origin_between_tags",
     "link 'b' (line 10): error: <origin> has <xyz> between its tags, where nothing is read; write <origin xyz=\"...\" rpy=\"...\"/>\n"
     "joint 'j' (line 19): error: <origin> has '0 0 -1' between its tags, where nothing is read; write <origin xyz=\"...\" rpy=\"...\"/>"},
    {"overflowing_number",
     "link 'b' (line 10): error: <mass value=\"1e999\"> is not a number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"quaternion_origin",
     "joint 'j' (line 18): error: <origin quat_xyzw> is not supported; write the rotation as rpy"},
    {"second_robot",
     "<robot> (line 20): error: there is another <robot> in line 1; keep one robot in this file"},
    {"two_parents",
     "joint 'l' (line 30): error: link 'c' is already the child of joint 'k' (line 25); a link has one parent: remove one of the two joints, and say in the scene what they hold together: loops"},
    {"two_roots",
     "robot 'r': error: there are 2 root links: link 'a' (line 2), link 'c' (line 14); make all but one of them the child of a joint, or remove them"},
    {"unknown_child",
     "joint 'k' (line 19): error: its child link 'hand' does not exist; add the link, or choose from a, b"},
    {"unknown_joint_type",
     "joint 'j' (line 14): error: joints of type 'universal' are not supported; write a type of URDF's, and what the joint is in the scene: joints: {joint: ...}"},
    {"unknown_parent",
     "joint 'j' (line 14): error: its parent link 'base_lnk' does not exist; add the link, or did you mean 'base_link'?"},
    {"welded_body_at_fault",
     "body 'b': error: the inertia is not positive definite (principal moments -2, 2, 2 kg m²) with all its links welded together, by fault of link 'c' (line 14); correct <inertia>: its matrix about the centre of mass has no negative principal moment; or go on knowingly with inertia: accept or inertia: repair in the scene"},
    {"xacro_block",
     "joint 'j' (line 18): error: <xacro:insert_block> in <origin> is left for xacro to expand: the file does not yet describe a robot; expand it with ROS's xacro: xacro xacro_block.urdf > expanded.urdf, and name that"},
    {"xacro_call",
     "robot 'r' (line 2): error: <xacro:if> is left for xacro to expand, as in 2 more places: the file does not yet describe a robot; expand it with ROS's xacro: xacro xacro_call.urdf > expanded.urdf, and name that"},
    {"xacro_definitions_only",
     "robot 'r' (line 2): error: <xacro:macro> is left for xacro to expand: the file does not yet describe a robot; expand it with ROS's xacro: xacro xacro_definitions_only.urdf > expanded.urdf, and name that"},
    {"xacro_find",
     "joint 'j' (line 16): error: <child link=\"$(arg prefix)b\"> is left for xacro to expand: the file does not yet describe a robot; expand it with ROS's xacro: xacro xacro_find.urdf > expanded.urdf, and name that"},
    {"xacro_include",
     "robot 'r' (line 3): error: <xacro:include> is left for xacro to expand, as in 1 more place: the file does not yet describe a robot; expand it with ROS's xacro: xacro xacro_include.urdf > expanded.urdf, and name that"},
    {"xacro_old_include",
     "robot 'r' (line 2): error: <include> is left for xacro to expand: the file does not yet describe a robot; expand it with ROS's xacro: xacro xacro_old_include.urdf > expanded.urdf, and name that"},
    {"xacro_lost_call_only",
     "robot 'r' (line 2): warning: <xacro:hand> in <robot> calls a macro that the file neither has nor includes, so that xacro cannot expand it: it is ignored; put what it stands for in its place, or remove it\n"
     "robot 'r': error: there are no links; add at least one <link>"},
    {"xacro_mass",
     "link 'b' (line 10): error: <mass value=\"${m}\"> is left for xacro to expand: the file does not yet describe a robot; expand it with ROS's xacro: xacro xacro_mass.urdf > expanded.urdf, and name that"},
    {"zero_inside_robot",
     "line 14: error: byte 0 is no character; save the file as text in UTF-8"},
    {"zero_axis",
     "joint 'j' (line 17): error: the axis has zero length; give the direction the joint turns about or slides along"},
};

const Case doubts[] = {
    {"ball_joint",
     "robot 'r' (line 18): warning: <drake:joint> is no element of URDF and is ignored; write a <joint> in its place where the dynamics needs it\n"
     "robot 'r' (line 19): warning: <loop_joint> is no element of URDF and is ignored: what it closes is open; say in the scene what holds which links together: loops\n"
     "joint 'j' (line 14): warning: URDF has no joints of type 'ball': a ball is taken; where others are to read the file, write type=\"continuous\", and in the scene joints: {j: spherical}"},
    {"blank_products",
     "link 'b' (line 11): warning: <inertia> has a blank ixz, iyz: zero is taken; write the number, 0 if it is none"},
    {"colliding_joints",
     "joint 'hip-yaw' (line 25): warning: the name becomes 'hip_yaw' in C++, as does that of joint 'hip/yaw' (line 20); it is called 'hip-yaw_' here"},
    {"colliding_links",
     "link 'b.1' (line 14): warning: the name becomes 'b_1' in C++, as does that of link 'b 1' (line 8); it is called 'b.1_' here"},
    {"contradicting_products",
     "link 'b' (line 11): warning: <inertia> has ixy=\"0\" and iyx=\"0.1\": ixy is taken; leave out the wrong one (the first of 2 such warnings; --verbose shows all)"},
    {"damping_and_friction",
     "joints 'j', 'k': warning: <dynamics damping> is left out; ask for it with damping: urdf in the scene\n"
     "joint 'j': warning: <dynamics friction> is left out; ask for it with friction: urdf in the scene"},
    {"end_tag_twice", "line 20: warning: </robot> outside of <robot> is ignored; remove it"},
    {"floating_beside_moving", "joint 'free': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene"},
    {"floating_leaf", "joint 'free': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene"},
    {"floating_root_with_inertia",
     "joint 'j' (line 14): warning: the inertia of link 'a' above this floating joint is not used: what is above it is the world and does not move; give it to the link below the joint\n"
     "joint 'j' (line 14): warning: the <origin> of this floating joint is not used; q gives the pose of its child in the world\n"
     "joint 'j' (line 14): warning: the <dynamics> of this floating joint is not used; a base has neither damping nor friction here: a run-time wrench can act on its link"},
    {"function_robot",
     "robot 'index': warning: 'index' is a name of the C++ library; its namespace is 'index_'; give another with --name"},
    {"guard_joint",
     "joint 'ARM_C_API_H' (line 14): warning: the name could be a macro of the generated code; it is called 'ARM_C_API_H_' here"},
    {"implicit_world",
     "joint 'stand' (line 14): warning: its parent link 'world' does not exist; it is added; write <link name=\"world\"/>"},
    {"incomplete_inertia",
     "link 'b' (line 11): warning: <inertia> has no iyz: zero is taken; give all of ixx, ixy, ixz, iyy, iyz, izz in kg m²"},
    {"inertia_but_no_mass_on_a_slide",
     "joint 'j': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene"},
    {"joint_of_the_compiler",
     "joint 'typeof' (line 14): warning: the name is a keyword of C++; it is called 'typeof_' here"},
    {"keyword_joint",
     "joint 'xor' (line 14): warning: the name is a keyword of C++; it is called 'xor_' here"},
    {"keyword_link",
     "link 'class' (line 8): warning: the name is a keyword of C++; it is called 'class_' here"},
    {"keyword_robot",
     "robot 'double': warning: 'double' is a keyword of C++; its namespace is 'double_'; give another with --name"},
    {"library_robot",
     "robot 'std': warning: 'std' is the name of a library the generated code uses; its namespace is 'std_'; give another with --name"},
    {"lower_products_zero",
     "link 'b' (line 11): warning: <inertia> has ixy=\"0.1\" and iyx=\"0\": ixy is taken; leave out the wrong one (the first of 2 such warnings; --verbose shows all)"},
    {"macro_joint",
     "joint 'NAN' (line 14): warning: the name is a macro of the C++ library; it is called 'NAN_' here"},
    {"macro_prefix_joint",
     "joint 'TBB_arm' (line 14): warning: the name is a macro of the C++ library; it is called 'joint_TBB_arm' here"},
    {"malformed_damping",
     "joint 'j' (line 18): warning: <dynamics damping=\"0.1 Nms\"> is not a number: it is not used; write finite decimal numbers such as 0.25 or 1e-3\n"
     "joint 'j': warning: <dynamics damping> is left out; ask for it with damping: urdf in the scene\n"
     "joint 'j': warning: <dynamics friction> is left out; ask for it with friction: urdf in the scene"},
    {"limits_exchanged",
     "joint 'j' (line 18): warning: lower 3.8 is above upper 2.8; exchange them, or correct a sign: no position is within\n"
     "joint 'j' (line 18): warning: effort -5 is negative; give the largest size allowed"},
    {"malformed_limit",
     "joint 'j' (line 18): warning: <limit upper=\"1.5rad\"> is not a number: it is not used; write finite decimal numbers such as 0.25 or 1e-3\n"
     "joint 'j' (line 18): warning: <limit effort=\"\"> is not a number: it is not used; write finite decimal numbers such as 0.25 or 1e-3\n"
     "joint 'j' (line 19): warning: <safety_controller k_velocity=\"fast\"> is not a number: it is not used; write finite decimal numbers such as 0.25 or 1e-3"},
    {"malformed_mimic",
     "joint 'k' (line 29): warning: <mimic multiplier=\"twice\"> is not a number: it is not used; write finite decimal numbers such as 0.25 or 1e-3\n"
     "joint 'k': warning: its <mimic> is left out: it is a joint of its own; ask for it with mimic: urdf in the scene"},
    {"massless_leaf",
     "joint 'k': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene"},
    {"massless_subtree",
     "joints 'k', 'l': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene"},
    {"mimic",
     "joint 'k': warning: its <mimic> is left out: it is a joint of its own; ask for it with mimic: urdf in the scene"},
    {"mimic_on_fixed_joint",
     "joint 'k': warning: its <mimic> is left out: it is a joint of its own; ask for it with mimic: urdf in the scene"},
    {"mimic_chain",
     "joints 'a', 'b', 'd': warning: their <mimic> is left out: they are joints of their own; ask for it with mimic: urdf in the scene"},
    {"mimic_chain_and_ring",
     "joints 'a', 'b', 'c', 'd': warning: their <mimic> is left out: they are joints of their own; ask for it with mimic: urdf in the scene"},
    {"mimic_of_others",
     "joints 'a', 'b', 'l_finger': warning: their <mimic> is left out: they are joints of their own; ask for it with mimic: urdf in the scene"},
    {"mimic_without_joint",
     "joint 'j': warning: its <mimic> is left out: it is a joint of its own; ask for it with mimic: urdf in the scene"},
    {"negative_by_rounding",
     "link 'b' (line 8): warning: a principal moment is negative by rounding (principal moments -2e-06, 1, 1 kg m²); it is used as given; write <inertia> with more digits"},
    {"negative_damping",
     "joint 'j': warning: <dynamics damping> is left out; ask for it with damping: urdf in the scene"},
    {"no_axis",
     "joint 'j' (line 14): warning: the joint has no <axis>; 1 0 0 is taken; write <axis xyz=\"1 0 0\"/>"},
    {"no_inertia",
     "link 'b' (line 9): warning: <inertial> has no <inertia>: zeros are taken; add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m²\n"
     "joint 'j': warning: link 'b' has no inertia about the joint's axis: M is singular; give the link a rotational inertia, or the joint an armature in the scene\n"
     "link 'b' (line 8): warning: the link has a mass but no rotational inertia: a point mass; give <inertia> if it has an extent"},
    {"no_mass",
     "link 'b' (line 9): warning: <inertial> has no <mass>: zero is taken; write <mass value=\"...\"/> in kg"},
    {"no_mass_value",
     "link 'b' (line 10): warning: <mass> has no value: zero is taken; write <mass value=\"...\"/> in kg"},
    {"no_robot_name",
     "robot 'no_robot_name' (line 1): warning: <robot> has no name; the file's is taken; write <robot name=\"...\">"},
    {"point_mass",
     "link 'b' (line 8): warning: the link has a mass but no rotational inertia: a point mass; give <inertia> if it has an extent"},
    {"point_mass_alone",
     "link 'a' (line 2): warning: the link has a mass but no rotational inertia: a point mass; give <inertia> if it has an extent\n"
     "base 'a': warning: can move without moving any mass, wherever the robot stands: the mass matrix is singular; give link 'a' moments of inertia about every axis"},
    {"point_mass_on_axis",
     "joint 'j': warning: link 'b' has no inertia about the joint's axis: M is singular; give the link a rotational inertia, or the joint an armature in the scene\n"
     "link 'b' (line 8): warning: the link has a mass but no rotational inertia: a point mass; give <inertia> if it has an extent"},
    {"stray_text",
     "robot 'r' (line 14): warning: the text 'two links;' in <robot> is ignored; remove it, or make it a comment: <!-- ... -->\n"
     "joint 'j' (line 19): warning: the text 'up -->' in <joint> is ignored; remove it, or make it a comment: <!-- ... -->"},
    {"triangle_inequality",
     "link 'b' (line 8): warning: the inertia breaks the triangle inequality by 0.5 kg m² (principal moments 1, 1, 2.5 kg m²); no body has such an inertia: no principal moment exceeds the sum of the others; it is used as given"},
    {"two_axes",
     "joint 'j' (line 17): warning: a second <axis> in <joint> is ignored; keep one of them"},
    {"two_floating_roots", "joint 'k': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene"},
    {"unknown_attribute",
     "joint 'j' (line 18): warning: unknown attribute 'xzy' of <origin> is ignored; the known ones are xyz, rpy"},
    {"text_behind_robot", "line 21: warning: the text 'the end' outside of <robot> is ignored; remove it"},
    {"unknown_attributes",
     "robot 'r' (line 1): warning: unknown attribute 'author' of <robot> is ignored; the known ones are name, version, xmlns\n"
     "link 'b' (line 8): warning: unknown attribute 'mass' of <link> is ignored; the known ones are name, type\n"
     "link 'b' (line 9): warning: unknown attribute 'mass' of <inertial> is ignored; remove it\n"
     "joint 'j' (line 14): warning: unknown attribute 'damping' of <joint> is ignored; the known ones are name, type\n"
     "joint 'j' (line 15): warning: unknown attribute 'xyz' of <parent> is ignored; the known ones are link\n"
     "joint 'j' (line 19): warning: unknown attribute 'dampping' of <dynamics> is ignored; the known ones are damping, friction\n"
     "joint 'j' (line 18): warning: unknown attribute 'force' of <limit> is ignored; the known ones are lower, upper, effort, velocity, acceleration, deceleration, jerk\n"
     "joint 'j' (line 20): warning: unknown attribute 'sinking' of <calibration> is ignored; the known ones are rising, falling, reference_position\n"
     "joint 'j' (line 21): warning: unknown attribute 'k_force' of <safety_controller> is ignored; the known ones are soft_lower_limit, soft_upper_limit, k_position, k_velocity"},
    {"unknown_tag_many_times",
     "joint 'j' (line 17): warning: unknown element <gear> in <joint> is ignored; the known ones are origin, parent, child, axis, limit, dynamics, mimic, calibration, safety_controller, gazebo, sensor, hardwareInterface (the first of 4 such warnings; --verbose shows all)"},
    {"unknown_tags",
     "robot 'r' (line 20): warning: unknown element <loop> in <robot> is ignored; the known ones are link, joint, material, transmission, gazebo, sensor, mujoco, plugin, ros2_control\n"
     "link 'b' (line 10): warning: unknown element <density> in <inertial> is ignored; the known ones are origin, mass, inertia\n"
     "joint 'j' (line 18): warning: unknown element <gear> in <joint> is ignored; the known ones are origin, parent, child, axis, limit, dynamics, mimic, calibration, safety_controller, gazebo, sensor, hardwareInterface"},
    {"welded_links_at_fault",
     "link 'c' (line 14): warning: the inertia is not positive definite (principal moments -3.5e-08, 0.0001, 0.0001 kg m²); that of body 'b', which the link is welded into, is sound: it is used as given; correct <inertia>\n"
     "link 'd' (line 20): warning: the mass is negative (-0.1 kg); that of body 'b', which the link is welded into, is sound: it is used as given; give the link a mass of zero or more\n"
     "link 'e' (line 26): warning: the inertia breaks the triangle inequality by 0.0005 kg m² (principal moments 0.001, 0.001, 0.0025 kg m²); that of body 'b', which the link is welded into, is sound: it is used as given; correct <inertia>"},
    {"xacro_lost_calls",
     "robot 'r' (line 20): warning: <xacro:hand> in <robot> calls a macro that the file neither has nor includes, so that xacro cannot expand it: it is ignored; put what it stands for in its place, or remove it\n"
     "joint 'j' (line 17): warning: <xacro:limits> in <joint> calls a macro that the file neither has nor includes, so that xacro cannot expand it: it is ignored; put what it stands for in its place, or remove it"},
    {"xacro_limit",
     "joint 'j' (line 18): warning: <limit lower=\"${-pi}\"> is not a number: it is not used; expand the file with ROS's xacro\n"
     "joint 'j' (line 18): warning: <limit upper=\"$(arg upper)\"> is not a number: it is not used; expand the file with ROS's xacro"},
    {"zero_behind_robot",
     "line 20: warning: a zero byte behind </robot> is ignored; save the file as text"},
    {"zeros_behind_robot",
     "line 19: warning: 3 zero bytes behind </robot> are ignored; save the file as text\n"
     "line 20: warning: the text 'the end' outside of <robot> is ignored; remove it"},
};

// Read without a word; in place of messages what `info` says then.
const Case sound[] = {
    {"blank_behind_mass", "-> b, 5 kg"},
    {"byte_order_mark", "robot r (r)"},
    {"coaxial_joints", "3 moving joints"},
    {"comments_between_tags", "j: revolute, 0 0 1 -> b"},
    {"comments_beside_robot", "robot r (r)"},
    {"doctype", "robot r (r)"},
    {"far_from_base", "2 moving joints"},
    {"floating_root", "floating base 'a', 1 moving joints, 2 links"},
    {"latin1", "-> b\u00e9, 1 kg"},
    {"light_base", "floating base 'a'"},
    {"massless_base", "fixed base 'a'"},
    {"mirrored_products", "robot r (r)"},
    {"newline_in_inertia", "robot r (r)"},
    {"odd_but_sound_numbers", "j: revolute, 0 -1 0 -> b, 5 kg"},
    {"planar_joint", "0-2 j: planar, 1 0 0 | 0 1 0 | 0 0 1 -> b, 1 kg"},
    {"plus_signs", "-> b, 5 kg"},
    {"sound", "robot r (r)"},  // all the others are made from it
    {"tabs_in_axis", "j: revolute, 0 -1 0 -> b"},
    {"utf16", "-> b\u00e9, 1 kg"},
    {"xacro_leftovers", "robot r (r)"},
    {"turned_wheel", "1 moving joint"},
};

const Use uses[] = {
    {"damping_of_one_joint", "damping_and_friction", {"--damping", "j=1", "--friction", "{}"}, 0,
     "joint 'k': warning: <dynamics damping> is left out; name them under damping too, with 0 where none is meant", ""},
    {"damping_of_both_joints", "damping_and_friction", {"--damping", "j=1,k=0", "--friction", "j=0"}, 0, "", ""},
    {"massless_locked", "massless_subtree", {"--massless", "lock"}, 0,
     "joints 'k', 'l': warning: what moves no mass is locked, as the scene says; lock it by name to choose where",
     "1 moving joints, 4 links"},
    {"massless_with_armature", "massless_subtree", {"--armature", "k=0.1,l=0.2"}, 0, "", "3 moving joints"},
    {"massless_with_payload", "massless_subtree", {"--payloads", "d"}, 0, "", "3 moving joints"},
    {"massless_driven_by_one_with_mass", "massless_leaf", {"--mimic", "{k: {of: j}}"}, 0, "", "nq = 8, nv = 7"},
    {"massless_driver_and_driven_locked", "massless_subtree", {"--mimic", "{l: {of: k, offset: 1}}", "--massless", "lock"}, 0,
     "joint 'k': warning: what moves no mass is locked, as the scene says; lock it by name to choose where", "1 moving joints"},
    {"floating_in_the_tree", "floating_leaf", {"--base", "fixed"}, 0,
     "joint 'free': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene",
     "nq = 8, nv = 7"},
    {"two_floating_in_the_world", "two_floating_roots", {"--base", "fixed"}, 0,
     "joint 'k': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene",
     "nq = 14, nv = 12"},
    {"floating_beside_a_joint_that_moves", "floating_beside_moving", {"--base", "fixed"}, 0,
     "joint 'free': warning: nothing that moves there has a mass: M is singular; lock such joints with massless: lock in the scene, give the links <inertial> with a mass, or the joints an armature in the scene",
     "nq = 8, nv = 7"},
    {"nothing_to_lock", "sound", {"--massless", "lock"}, 0, "", "1 moving joints"},
    {"no_centre_of_mass", "inertia_but_no_mass_on_a_slide",
     {"--base", "fixed", "--armature", "j=0.1", "--outputs", "gravity,center_of_mass"}, 2,
     "robot 'r': error: nothing that moves has a mass: there is no centre of mass; give the links <inertial> with a mass, or leave out what refers to the centre of mass", ""},
    {"no_mass_kinematics", "no_mass_at_all", {"--outputs", "wrench_influence", "--jacobians", "b", "--verbose"}, 0,
     "link 'a' (line 3): warning: <inertial> has no <inertia>: zeros are taken; add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m²\n"
     "link 'b' (line 9): warning: <inertial> has no <inertia>: zeros are taken; add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m²",
     "jacobian_b"},
    {"no_mass_floating", "no_mass_at_all", {"--base", "floating", "--outputs", "gravity,wrench_influence", "--verbose"}, 2,
     "link 'a' (line 3): warning: <inertial> has no <inertia>: zeros are taken; add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m²\n"
     "link 'b' (line 9): warning: <inertial> has no <inertia>: zeros are taken; add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m²\n"
     "robot 'r': error: nothing that moves has a mass: there are no dynamics; give the links <inertial> with a mass, or ask for what needs none: --outputs wrench_influence, or --outputs '' --jacobians LINK", ""},
    {"negative_accepted", "negative_inertia", {"--inertia", "accept"}, 0,
     "link 'b' (line 8): warning: the inertia is not positive definite (principal moments -1, 1, 1 kg m²) and used as given, as the scene says; correct <inertia>\n"
     "base 'a': warning: can move without moving any mass, wherever the robot stands: the mass matrix is singular; give link 'a' moments of inertia about every axis, or ask for --base fixed",
     "1 moving joints"},
    {"negative_repaired", "negative_inertia", {"--inertia", "repair"}, 0,
     "link 'b' (line 8): warning: the inertia is no body's (principal moments -1, 1, 1 kg m²) and repaired, as the scene says (principal moments 0, 1.5, 1.5 kg m²); correct <inertia>",
     "1 moving joints"},
    {"triangle_repaired", "triangle_inequality", {"--inertia", "repair"}, 0,
     "link 'b' (line 8): warning: the inertia is no body's (principal moments 1, 1, 2.5 kg m²) and repaired, as the scene says (principal moments 1.25, 1.25, 2.5 kg m²); correct <inertia>",
     "1 moving joints"},
    {"sound_repaired", "sound", {"--inertia", "repair"}, 0, "", "1 moving joints"},
    {"negative_mass_accepted", "negative_mass", {"--inertia", "accept"}, 0,
     "link 'b' (line 8): warning: the mass is negative (-1 kg) and used as given, as the scene says\n"
     "base 'a': warning: can move without moving any mass, wherever the robot stands: the mass matrix is singular; give link 'a' moments of inertia about every axis, or ask for --base fixed", "1 moving joints"},
    {"negative_mass_not_repaired", "negative_mass", {"--inertia", "repair"}, 2,
     "link 'b' (line 8): error: the mass is negative (-1 kg); give the link a mass of zero or more, or go on knowingly with inertia: accept in the scene", ""},
    {"negative_welded_by_a_lock", "negative_behind_joint", {"--locked", "k"}, 0,
     "link 'c' (line 14): warning: the inertia is not positive definite (principal moments -0.015, 1, 1 kg m²); that of body 'b', which the link is welded into, is sound: it is used as given; correct <inertia>",
     "1 moving joints"},
    {"welded_body_accepted", "welded_body_at_fault", {"--inertia", "accept"}, 0,
     "body 'b': warning: the inertia is not positive definite (principal moments -2, 2, 2 kg m²) with all its links welded together, by fault of link 'c' (line 14) and used as given, as the scene says; correct <inertia>",
     "1 moving joints"},
    {"welded_body_repaired", "welded_body_at_fault", {"--inertia", "repair"}, 0,
     "body 'b': warning: the inertia is no body's (principal moments -2, 2, 2 kg m²) with all its links welded together, by fault of link 'c' (line 14) and repaired, as the scene says (principal moments 0, 3, 3 kg m²); correct <inertia>",
     "1 moving joints"},
    {"cancelling_masses_accepted", "cancelling_masses", {"--inertia", "accept"}, 2,
     "body 'b': error: the masses of its links cancel: there is no centre of mass; negative is that of link 'c' (line 14); give these links a mass of zero or more", ""},
    {"negative_cut_off", "negative_inertia", {"--cut", "b"}, 0, "", "0 moving joints"},
    {"negative_damping_asked_for", "negative_damping", {"--damping", "urdf"}, 2,
     "option --damping: error: the URDF's damping of joint 'j' is negative (-1); correct it in the URDF, or give values: damping: {joint: value}", ""},
    {"malformed_damping_asked_for", "malformed_damping", {"--damping", "urdf", "--friction", "urdf"}, 2,
     "joint 'j' (line 18): warning: <dynamics damping=\"0.1 Nms\"> is not a number: it is not used; write finite decimal numbers such as 0.25 or 1e-3\n"
     "option --damping: error: the URDF's damping of joint 'j' is no finite number; correct it in the URDF, or give values: damping: {joint: value}", ""},
    {"malformed_mimic_asked_for", "malformed_mimic", {"--mimic", "urdf"}, 2,
     "joint 'k' (line 29): warning: <mimic multiplier=\"twice\"> is not a number: it is not used; write finite decimal numbers such as 0.25 or 1e-3\n"
     "joint 'k' (line 25): error: its <mimic> has no finite multiplier and offset; correct it in the URDF, or write the relations in the scene: mimic: {joint: {of: other_joint}}", ""},
    {"mimic_of_nobody_asked_for", "mimic_without_joint", {"--mimic", "urdf"}, 2,
     "joint 'j' (line 14): error: its <mimic> names no joint; correct it in the URDF, or write the relations in the scene: mimic: {joint: {of: other_joint}}", ""},
    {"mimic_ring", "mimic_chain", {"--mimic", "{a: {of: d}, d: {of: b}, b: {of: a}}", "--base", "fixed"}, 2,
     "option --mimic: error: joints 'a', 'd', 'b' follow one another in a ring: none moves by itself; let one of them follow a joint outside of the ring, or none", ""},
    {"mimic_ring_in_urdf", "mimic_chain_and_ring", {"--mimic", "urdf", "--base", "fixed"}, 2,
     "joint 'd' (line 28): error: joint 'd' drives itself; name another joint as its driver\n"
     "joint 'a' (line 7): error: joints 'a', 'b' follow one another in a ring: none moves by itself; let one of them follow a joint outside of the ring, or none", ""},
    {"mimic_of_joints_that_do_not_move", "mimic_of_others", {"--mimic", "urdf", "--base", "fixed", "--locked", "r=0.5"}, 2,
     "joint 'a' (line 12): error: it follows joint 'r', which is locked; lock it too: locked: {a: -0.9}; or unlock 'r'\n"
     "joint 'b' (line 18): error: it follows joint 'f', which is fixed; lock it too: locked: {b: 0.2}; or correct its <mimic> in the URDF, or write the relations in the scene: mimic: {joint: {of: other_joint}}\n"
     "joint 'l_finger' (line 24): error: it follows joint 'finger', which does not exist; add that joint, or remove the <mimic>", ""},
    {"mimic_of_what_is_cut_off", "mimic_of_others", {"--mimic", "urdf", "--base", "fixed", "--cut", "rl", "--locked", "b,l_finger"}, 2,
     "joint 'a' (line 12): error: it follows joint 'r', which is cut off; cut it off too, lock it, or take the link that 'r' belongs to out of 'cut'", ""},
    {"mimic_of_nobody_there", "mimic_of_others", {"--mimic", "urdf", "--base", "fixed", "--locked", "b"}, 2,
     "joint 'l_finger' (line 24): error: it follows joint 'finger', which does not exist; correct its <mimic> in the URDF, or write the relations in the scene: mimic: {joint: {of: other_joint}}; choose from r", ""},
    {"mimic_on_fixed_joint_asked_for", "mimic_on_fixed_joint", {"--mimic", "urdf", "--base", "fixed"}, 0,
     "joint 'f': warning: a fixed joint follows no other: <mimic> is left out; remove it there, or give the joint another type",
     "nq = 1, nv = 1"},
    {"massless_base_floats", "massless_base", {"--base", "floating", "--outputs", "bias,forward_dynamics"}, 2,
     "base 'a', joint 'j': error: can move without moving any mass, wherever the robot stands: the mass matrix is singular, and there is no forward_dynamics; give link 'a' an <inertial> with a mass and an extent, or ask for --base fixed; or lock the joint, or give it an armature", ""},
    {"point_mass_floats", "point_mass_alone", {"--base", "floating", "--outputs", "forward_dynamics"}, 2,
     "link 'a' (line 2): warning: the link has a mass but no rotational inertia: a point mass; give <inertia> if it has an extent\n"
     "base 'a': error: can move without moving any mass, wherever the robot stands: the mass matrix is singular, and there is no forward_dynamics; give link 'a' moments of inertia about every axis", ""},
    {"point_mass_fixed", "point_mass_alone", {"--base", "fixed", "--outputs", "forward_dynamics"}, 2,
     "robot 'r': error: no joint is left to move and the base is fixed; give it a joint that moves, or give a link an <inertial> with a mass and an extent and ask for --base floating", ""},
    {"point_mass_fixed_without_inverse", "point_mass_alone", {"--base", "fixed", "--outputs", "mass_matrix"}, 2,
     "robot 'r': error: no joint is left to move and the base is fixed; give it a joint that moves, or ask for --base floating", ""},
    {"point_mass_floats_without_inverse", "point_mass_alone", {"--base", "floating", "--outputs", "mass_matrix"}, 0,
     "link 'a' (line 2): warning: the link has a mass but no rotational inertia: a point mass; give <inertia> if it has an extent\n"
     "base 'a': warning: can move without moving any mass, wherever the robot stands: the mass matrix is singular; give link 'a' moments of inertia about every axis", "nv = 6"},
    {"all_is_cut_off", "massless_base", {"--base", "fixed", "--cut", "b"}, 2,
     "robot 'r': error: no joint is left to move and the base is fixed; cut off less, or give a link an <inertial> with a mass and an extent and ask for --base floating", ""},
    {"all_that_moves_no_mass_is_locked", "no_mass_at_all", {"--base", "fixed", "--massless", "lock"}, 2,
     "link 'a' (line 3): warning: <inertial> has no <inertia>: zeros are taken; add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../> in kg m² (the first of 2 such warnings; --verbose shows all)\n"
     "joint 'j': warning: what moves no mass is locked, as the scene says; lock it by name to choose where\n"
     "robot 'r': error: no joint is left to move and the base is fixed; let a joint move a mass, or give a link an <inertial> with a mass and an extent and ask for --base floating", ""},
    {"massless_base_needs_no_inverse", "massless_base", {"--base", "floating", "--outputs", "mass_matrix,inverse_dynamics"}, 0, "base 'a', joint 'j': warning: can move without moving any mass, wherever the robot stands: the mass matrix is singular; give link 'a' an <inertial> with a mass and an extent, or ask for --base fixed; or lock the joint, or give it an armature", "nv = 8"},
    {"massless_base_with_locked_joint", "massless_base", {"--base", "floating", "--outputs", "inverse_mass_matrix", "--locked", "j"}, 0, "", "nv = 7"},
    {"massless_base_with_payload", "massless_base", {"--base", "floating", "--outputs", "mass_matrix_factor", "--payloads", "a"}, 0, "", "nv = 8"},
    {"light_base_is_sound", "light_base", {"--outputs", "mass_matrix_factor,inverse_mass_matrix,forward_dynamics,forward_dynamics_dq,forward_dynamics_dv"}, 0, "", "nv = 8"},
    {"coaxial_joints_without_inverse", "coaxial_joints", {"--outputs", "forward_dynamics_dv"}, 2,
     "joints 'k', 'l': error: can move without moving any mass, wherever the robot stands: the mass matrix is singular, and there is no forward_dynamics_dv; give the links that move <inertial> with a mass and an extent; or lock one of the joints, or give it an armature", ""},
    {"coaxial_joints_with_armature", "coaxial_joints", {"--outputs", "forward_dynamics_dv", "--armature", "l=0.01"}, 0, "", "nv = 3"},
    {"world_floats", "implicit_world", {"--base", "floating"}, 0,
     "joint 'stand' (line 14): warning: its parent link 'world' does not exist; it is added; write <link name=\"world\"/>",
     "floating base 'world'"},
    {"floating_root_fixed", "floating_root", {"--base", "fixed"}, 0, "", "nq = 1, nv = 1"},
    {"floating_root_locked", "floating_root", {"--locked", "free=0"}, 2,
     "option --locked: error: joint 'free' is the floating base, and none of the joints that move on it; remove it here; base: fixed welds its link to the world",
     ""},
    {"renamed_joint_in_the_scene", "colliding_joints", {"--locked", "hip-yaw_"}, 0,
     "joint 'hip-yaw' (line 25): warning: the name becomes 'hip_yaw' in C++, as does that of joint 'hip/yaw' (line 20); it is called 'hip-yaw_' here",
     "1 moving joints"},
};
// clang-format on

class Defect : public testing::TestWithParam<Case> {};
class Doubt : public testing::TestWithParam<Case> {};
class Sound : public testing::TestWithParam<Case> {};
class InScene : public testing::TestWithParam<Use> {};

TEST_P(Defect, IsRefusedWithElementAndRemedyAndNothingIsWritten) {
  const TemporaryFolder folder;
  const std::string out = folder.path() + "/out";
  for (const std::vector<std::string>& command : {std::vector<std::string>{"generate", "-o", out}, {"info"}}) {
    std::vector<std::string> arguments = command;
    arguments.insert(arguments.begin() + 1, std::string(GetParam().robot) + ".urdf");
    const Outcome run = run_dalembert(arguments, ERROR_ROBOTS);
    EXPECT_EQ(run.status, 2);
    EXPECT_EQ(run.err, expected(GetParam()));
    EXPECT_EQ(run.out, "");
  }
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_P(Doubt, IsWarnedAboutAndTheRobotIsRead) {
  const Outcome run = run_dalembert({"info", std::string(GetParam().robot) + ".urdf"}, ERROR_ROBOTS);
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(said(run.err).all_else, expected(GetParam()));
  EXPECT_EQ(said(run.err).notices.empty(), says_of_its_base(GetParam().robot)) << run.err;
  EXPECT_TRUE(run.out.starts_with("robot ")) << run.out;
}

TEST_P(Sound, IsReadInSilence) {
  const Outcome run = run_dalembert({"info", std::string(GetParam().robot) + ".urdf"}, ERROR_ROBOTS);
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(said(run.err).all_else, "");
  EXPECT_EQ(said(run.err).notices.empty(), says_of_its_base(GetParam().robot)) << run.err;
  EXPECT_NE(run.out.find(GetParam().messages), std::string::npos) << run.out;
}

TEST_P(InScene, HasTheOutcomePromised) {
  const Use& use = GetParam();
  std::vector<std::string> arguments{"info", std::string(use.robot) + ".urdf"};
  arguments.insert(arguments.end(), use.options.begin(), use.options.end());
  const Outcome run = run_dalembert(arguments, ERROR_ROBOTS);
  EXPECT_EQ(run.status, use.status);
  std::string messages;
  std::istringstream lines(said(run.err).all_else);
  const std::string prefix = std::string(use.robot) + ".urdf: ";
  for (std::string line; std::getline(lines, line);)
    messages += (messages.empty() ? "" : "\n") + (line.starts_with(prefix) ? line.substr(prefix.size()) : line);
  EXPECT_EQ(messages, use.messages);
  const bool asked = std::find(use.options.begin(), use.options.end(), "--base") != use.options.end();
  EXPECT_EQ(said(run.err).notices.empty(), asked || use.status != 0 || says_of_its_base(use.robot)) << run.err;
  EXPECT_NE(run.out.find(use.output), std::string::npos) << run.out;
}

INSTANTIATE_TEST_SUITE_P(Urdf, Defect, testing::ValuesIn(defects), name_of);
INSTANTIATE_TEST_SUITE_P(Urdf, Doubt, testing::ValuesIn(doubts), name_of);
INSTANTIATE_TEST_SUITE_P(Urdf, Sound, testing::ValuesIn(sound), name_of);
INSTANTIATE_TEST_SUITE_P(Urdf, InScene, testing::ValuesIn(uses), [](const auto& info) { return std::string(info.param.name); });

// Every file here is in one of the tables.
TEST(Urdf, EveryFileIsTested) {
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(ERROR_ROBOTS)) files += entry.path().extension() == ".urdf";
  EXPECT_EQ(files, std::size(defects) + std::size(doubts) + std::size(sound) + 1);  // and all_attributes
}

TEST(Urdf, VerboseTellsEveryWarning) {
  const Outcome run = run_dalembert({"info", "unknown_tag_many_times.urdf", "--verbose"}, ERROR_ROBOTS);
  EXPECT_EQ(run.status, 0);
  const std::string warnings = said(run.err).all_else;
  EXPECT_EQ(std::count(warnings.begin(), warnings.end(), '\n'), 4);
  for (const char* joint : {"'j'", "'k0'", "'k1'", "'k2'"}) EXPECT_NE(run.err.find(joint), std::string::npos) << run.err;
  EXPECT_EQ(run.err.find("--verbose"), std::string::npos) << run.err;
}

TEST(Urdf, WhatBaseIsTakenIsSaidWhereNobodySays) {
  const TemporaryFolder folder;
  const std::string scene = folder.path() + "/scene.yaml", states = folder.path() + "/states";
  write_text(scene, "base: floating\n");
  write_text(states, "0 0 0 0 0 0 1 0  0 0 0 0 0 0 0\n");
  const std::string floats =
      "sound.urdf: link 'a': notice: neither the scene nor the URDF says whether this base moves: it floats, for it has an "
      "inertia; weld it to the world with --base fixed, or say --base floating\n";
  const std::string fixed =
      "massless_base.urdf: link 'a': notice: neither the scene nor the URDF says whether this base moves: it is fixed, for it "
      "has no inertia; let it move with --base floating, or say --base fixed\n";
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"info", "sound.urdf"},
           {"info", "sound.urdf", "--json"},
           {"generate", "sound.urdf", "-o", folder.path() + "/out"},
           {"eval", "sound.urdf", "--state", states, "--output", "bias", "--engine", "generic"}}) {
    const Outcome silent = run_dalembert(command, ERROR_ROBOTS);
    EXPECT_EQ(silent.status, 0);
    EXPECT_EQ(silent.err, floats) << command[0];
    for (const std::vector<std::string>& saying : {std::vector<std::string>{"--base", "floating"}, {"--scene", scene}}) {
      std::vector<std::string> arguments = command;
      arguments.insert(arguments.end(), saying.begin(), saying.end());
      const Outcome run = run_dalembert(arguments, ERROR_ROBOTS);
      EXPECT_EQ(run.err, "") << command[0];
      // What generate prints has the size of a banner that says the option.
      EXPECT_TRUE(command[0] == "generate" || run.out == silent.out) << run.out;
    }
  }
  EXPECT_EQ(run_dalembert({"info", "massless_base.urdf"}, ERROR_ROBOTS).err, fixed);
  EXPECT_EQ(
      said(run_dalembert({"info", "point_mass_alone.urdf"}, ERROR_ROBOTS).err).notices,
      "point_mass_alone.urdf: link 'a': notice: neither the scene nor the URDF says whether this base moves: it floats, for it "
      "has an inertia; say --base floating: no joint would move of one that is fixed\n");
  EXPECT_EQ(run_dalembert({"info", "massless_base.urdf", "--base", "fixed"}, ERROR_ROBOTS).err, "");
}

// a follows b, b follows c, d follows a: all follow c.
TEST(Urdf, ChainsOfMimicJointsAreComposed) {
  const TemporaryFolder folder;
  const std::string states = folder.path() + "/states";
  write_text(states, "0.5 -1.25\n");
  const auto of = [&](const std::string& mimic, const char* output) {
    const Outcome run = run_dalembert({"eval", "mimic_chain.urdf", "--base", "fixed", "--engine", "generic", "--armature",
                                       "{a: 1, b: 2, c: 3, d: 4}", "--state", states, "--output", output, "--mimic", mimic},
                                      ERROR_ROBOTS);
    EXPECT_EQ(run.status, 0) << run.err;
    EXPECT_EQ(run.err, "");
    return run.out;
  };
  for (const char* output : {"mass_matrix", "bias"}) {
    const std::string direct =
        of("{a: {of: c, multiplier: -1, offset: 0.75}, b: {of: c, multiplier: 0.5, offset: -0.25}, "
           "d: {of: c, multiplier: -0.25, offset: 1.1875}}",
           output);
    EXPECT_FALSE(direct.empty());
    EXPECT_EQ(of("urdf", output), direct);
    EXPECT_EQ(of("{d: {of: a, multiplier: 0.25, offset: 1}, a: {of: b, multiplier: -2, offset: 0.25}, "
                 "b: {of: c, multiplier: 0.5, offset: -0.25}}",
                 output),
              direct);
  }
}

// The text with blanks, line ends and tabs at both ends of every attribute and between its numbers.
std::string strewn(const std::string& text) {
  std::string result;
  bool inside = false;
  for (char c : text) {
    if (c == '"' && inside) result += "\t\n ";
    if (c == ' ' && inside) result += "\t\r\n ";
    result += c;
    if (c != '"') continue;
    inside = !inside;
    if (inside) result += " \n\t";
  }
  return result;
}

// The emitted files one after the other, but for the banner's lines with the URDF's hash.
std::string code_of(const std::string& urdf, const std::vector<std::string>& options) {
  const TemporaryFolder folder;
  write_text(folder.path() + "/r.urdf", urdf);
  std::vector<std::string> arguments{"generate", "r.urdf", "-o", "out", "--base", "floating"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Outcome run = run_dalembert(arguments, folder.path());
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.err, "");
  std::string code;
  for (const char* name : {"dynamics.hpp", "dynamics.cpp"}) {
    std::istringstream lines(text_of(folder.path() + "/out/" + name));
    for (std::string line; std::getline(lines, line);)
      if (line.find("r.urdf (") == line.npos) code += line + "\n";
  }
  return code;
}

TEST(Urdf, BlanksLineEndsAndTabsInAttributesChangeNothing) {
  const std::string urdf = text_of(ERROR_ROBOTS "/all_attributes.urdf");
  for (const std::vector<std::string>& options :
       std::vector<std::vector<std::string>>{{"--mimic", "urdf", "--damping", "urdf", "--friction", "urdf"},
                                             {"--mimic", "{}", "--damping", "urdf", "--friction", "urdf", "--locked", "k"}}) {
    const std::string code = code_of(urdf, options);
    EXPECT_GT(code.size(), 5000u);
    EXPECT_EQ(code_of(strewn(urdf), options), code);
  }
}

// Every number of the file reaches the code: change a digit anywhere, and another robot comes out.
TEST(Urdf, EveryNumberThatMattersIsRead) {
  const std::string urdf = text_of(ERROR_ROBOTS "/all_attributes.urdf");
  const std::vector<std::string> options{"--mimic", "urdf", "--damping", "urdf", "--friction", "urdf"};
  const std::string code = code_of(urdf, options);
  int changed = 0;
  for (size_t at = 0; at < urdf.size(); ++at) {
    const size_t tag = urdf.rfind('<', at);
    const std::string element = urdf.substr(tag, urdf.find_first_of(" />", tag + 1) - tag);
    if (element == "<limit" || element == "<calibration" || element == "<safety_controller" || urdf[at] < '1' || urdf[at] > '8')
      continue;
    std::string other = urdf;
    ++other[at];
    EXPECT_NE(code_of(other, options), code)
        << urdf.substr(tag, urdf.find('>', at) - tag + 1) << " at its character " << at - tag;
    ++changed;
  }
  EXPECT_GT(changed, 60);
}

TEST(Urdf, MissingFilesAndFoldersAreRefused) {
  Outcome run = run_dalembert({"info", "no_such.urdf"}, ERROR_ROBOTS);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err, "no_such.urdf: error: there is no such file; name a URDF file that can be read\n");
  run = run_dalembert({"info", "."}, ERROR_ROBOTS);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.err, ".: error: this is a directory; name a URDF file that can be read\n");
}

// Debian's atlas_v3.urdf has lost a link.
TEST(Urdf, BrokenAtlasIsRefused) {
  const std::string atlas = "/usr/share/doc/dart/data/sdf/atlas/atlas_v3.urdf";
  if (!std::filesystem::exists(atlas)) GTEST_SKIP() << "Debian's package dart-doc is not installed";
  const Outcome run = run_dalembert({"info", atlas}, ERROR_ROBOTS);
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find("joint 'neck_ry' (line 715): error: its child link 'head' does not exist; add the link"),
            std::string::npos)
      << run.err;
}

}  // namespace
}  // namespace dalembert::test
