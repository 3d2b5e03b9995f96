// One URDF per defect in this folder, each with what the user reads about it, word for word.
#include <gtest/gtest.h>

#include <filesystem>

#include "run_dalembert.hpp"

namespace dalembert::test {
namespace {

struct Case {
  const char* robot;     // file in this folder, without .urdf
  const char* messages;  // lines of stderr, without the file's name in front
};

void PrintTo(const Case& c, std::ostream* os) { *os << c.robot; }
std::string name_of(const testing::TestParamInfo<Case>& info) { return info.param.robot; }

// Every line of the messages with the file's name in front.
std::string expected(const Case& c) {
  const std::string prefix = std::string(c.robot) + ".urdf: ";
  std::string text = prefix;
  for (const char* at = c.messages; *at; ++at) text += *at == '\n' ? "\n" + prefix : std::string(1, *at);
  return text + "\n";
}

// clang-format off
const Case defects[] = {
    {"axis_without_xyz",
     "joint 'j' (line 17): error: <axis> has no xyz; write <axis xyz=\"0 0 1\"/> or another direction"},
    {"colliding_joints",
     "joint 'hip-yaw' (line 25): error: the name becomes 'hip_yaw' in C++, as does that of joint 'hip/yaw' (line 20); rename one of them"},
    {"colliding_links",
     "link 'b.1' (line 14): error: the name becomes 'b_1' in C++, as does that of link 'b 1' (line 8); rename one of them"},
    {"cycle_beside_tree",
     "joint 'l' (line 36): error: the joints form a cycle: each link's parent is the next of c, d, c; remove one joint of the cycle, so that one root link remains"},
    {"cycle_without_root",
     "joint 'k' (line 19): error: the joints form a cycle: each link's parent is the next of a, b, a; remove one joint of the cycle, so that one root link remains"},
    {"duplicate_joint",
     "joint 'j' (line 25): error: the name is already taken by the joint of line 20; rename one of them"},
    {"duplicate_link",
     "link 'b' (line 14): error: the name is already taken by the link of line 8; rename one of them"},
    {"empty",
     "error: the file is empty; name a URDF file"},
    {"floating_joint",
     "joint 'j' (line 14): error: joints of type 'floating' are not supported; remove the joint and the link above it, and ask for --base floating"},
    {"incomplete_inertia",
     "link 'b' (line 11): error: <inertia> has no iyz; give all of ixx, ixy, ixz, iyy, iyz, izz in kg m²"},
    {"indefinite_inertia",
     "link 'b' (line 8): error: the inertia is not positive definite (principal moments -1, 1, 3 kg m²); correct <inertia>: its matrix about the centre of mass has no negative principal moment"},
    {"inertia_but_no_mass_on_a_slide",
     "joint 'j': error: it moves link 'b' and what is beyond it without any mass: M would be singular; give a link beyond it an <inertial>, make the joint fixed, or lock or cut it in the scene"},
    {"infinite_mass",
     "link 'b' (line 10): error: <mass value=\"inf\"> is not a finite number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"infinite_rpy",
     "joint 'j' (line 18): error: <origin rpy=\"0 0 -inf\"> is not three finite numbers; write finite decimal numbers such as 0.25 or 1e-3"},
    {"joint_to_itself",
     "joint 'k' (line 19): error: the joint connects link 'b' to itself; name two different links"},
    {"keyword_joint",
     "joint 'xor' (line 14): error: the name is a keyword of C++; rename it, for example 'xor_'"},
    {"keyword_link",
     "link 'class' (line 8): error: the name is a keyword of C++; rename it, for example 'class_'"},
    {"keyword_robot",
     "robot 'double': error: 'double' is a keyword of C++; give another with --name: letters, digits and '_', not starting with a digit"},
    {"library_robot",
     "robot 'std': error: 'std' is the name of a library the generated code uses; give another with --name: letters, digits and '_', not starting with a digit"},
    {"macro_joint",
     "joint 'NAN' (line 14): error: the name is a macro of the C++ library; rename it, for example 'NAN_'"},
    {"function_robot",
     "robot 'index': error: 'index' is a name of the C++ library; give another with --name: letters, digits and '_', not starting with a digit"},
    {"malformed_axis",
     "joint 'j' (line 17): error: <axis xyz=\"0 1\"> is not three finite numbers; write finite decimal numbers such as 0.25 or 1e-3"},
    {"malformed_mass",
     "link 'b' (line 10): error: <mass value=\"1,5\"> is not a number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"malformed_xml",
     "line 3, column 1: error: this is not well-formed XML: Error reading end tag.; close the tag or quote opened there"},
    {"massless_leaf",
     "joint 'k': error: it moves link 'c' and what is beyond it without any mass: M would be singular; give a link beyond it an <inertial>, make the joint fixed, or lock or cut it in the scene"},
    {"massless_subtree",
     "joint 'k': error: it moves link 'c' and what is beyond it without any mass: M would be singular; give a link beyond it an <inertial>, make the joint fixed, or lock or cut it in the scene\n"
     "joint 'l': error: it moves link 'd' and what is beyond it without any mass: M would be singular; give a link beyond it an <inertial>, make the joint fixed, or lock or cut it in the scene"},
    {"mimic_without_joint",
     "joint 'j' (line 18): error: <mimic> has no joint; name the joint that drives this one, or remove <mimic>"},
    {"nan_axis",
     "joint 'j' (line 17): error: <axis xyz=\"0 nan 1\"> is not three finite numbers; write finite decimal numbers such as 0.25 or 1e-3"},
    {"nan_inertia",
     "link 'b' (line 11): error: <inertia iyy=\"nan\"> is not a finite number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"nan_origin",
     "link 'b' (line 10): error: <origin xyz=\"nan 0 0\"> is not three finite numbers; write finite decimal numbers such as 0.25 or 1e-3"},
    {"negative_damping",
     "joint 'j' (line 18): error: the damping is negative (-1); give a value of zero or more"},
    {"negative_inertia",
     "link 'b' (line 8): error: the inertia is not positive definite (principal moments -1, 1, 1 kg m²); correct <inertia>: its matrix about the centre of mass has no negative principal moment"},
    {"negative_mass",
     "link 'b' (line 10): error: the mass is negative (-1 kg); give the link a mass of zero or more"},
    {"no_child",
     "joint 'j' (line 14): error: the joint has no <child>; add <child link=\"...\"/>"},
    {"no_inertia",
     "link 'b' (line 9): error: <inertial> has no <inertia>; add <inertia ixx=... ixy=... ixz=... iyy=... iyz=... izz=.../>"},
    {"no_joint_type",
     "joint 'j' (line 14): error: <joint> has no type; write type=\"revolute\", continuous, prismatic or fixed"},
    {"no_link_name",
     "link number 2 (line 8): error: <link> has no name; write <link name=\"...\">"},
    {"no_links",
     "robot 'r': error: there are no links; add at least one <link>"},
    {"no_mass",
     "link 'b' (line 9): error: <inertial> has no <mass>; add <mass value=\"...\"/>, or remove <inertial>"},
    {"no_mass_value",
     "link 'b' (line 10): error: <mass> has no value; write <mass value=\"...\"/> in kg"},
    {"no_parent",
     "joint 'j' (line 14): error: the joint has no <parent>; add <parent link=\"...\"/>"},
    {"no_parent_link",
     "joint 'j' (line 15): error: <parent> has no link; add <parent link=\"...\"/>"},
    {"no_robot",
     "<sdf> (line 1): error: there is no <robot> element; a URDF's root is <robot>; convert other formats such as SDF or MJCF to URDF first"},
    {"no_robot_name",
     "robot '' (line 1): error: <robot> has no name; write <robot name=\"...\">"},
    {"not_xml",
     "error: this is not XML; a URDF is an XML file whose root is <robot>"},
    {"nothing_moves",
     "robot 'r': error: no joint is left to move and the base is fixed; unlock a joint, or ask for --base floating"},
    {"overflowing_number",
     "link 'b' (line 10): error: <mass value=\"1e999\"> is not a number; write finite decimal numbers such as 0.25 or 1e-3"},
    {"planar_joint",
     "joint 'j' (line 14): error: joints of type 'planar' are not supported; write it as two prismatic joints and a revolute one"},
    {"quaternion_origin",
     "joint 'j' (line 18): error: <origin quat_xyzw> is not supported; write the rotation as rpy"},
    {"two_parents",
     "joint 'l' (line 30): error: link 'c' is already the child of joint 'k' (line 25); a link has one parent: remove one of the two joints (closed loops are not supported)"},
    {"two_roots",
     "robot 'r': error: there are 2 root links: link 'a' (line 2), link 'c' (line 14); make all but one of them the child of a joint, or remove them"},
    {"unknown_child",
     "joint 'k' (line 19): error: its child link 'hand' does not exist; add the link, or choose from a, b"},
    {"unknown_joint_type",
     "joint 'j' (line 14): error: joints of type 'spherical' are not supported; use revolute, continuous, prismatic or fixed"},
    {"unknown_parent",
     "joint 'j' (line 14): error: its parent link 'base_lnk' does not exist; add the link, or did you mean 'base_link'?"},
    {"xacro_mass",
     "link 'b' (line 10): error: <mass value=\"${m}\"> is not a number; expand the file with xacro first"},
    {"zero_axis",
     "joint 'j' (line 17): error: the axis has zero length; give the direction the joint turns about or slides along"},
};

const Case doubts[] = {
    {"damping_and_friction",
     "joints 'j', 'k': warning: <dynamics damping> is left out; ask for it with damping: urdf in the scene\n"
     "joint 'j': warning: <dynamics friction> is left out; ask for it with friction: urdf in the scene"},
    {"mimic",
     "joint 'k': warning: its <mimic> of 'j' is left out: it is a joint of its own; ask for it with mimic: urdf in the scene"},
    {"no_axis",
     "joint 'j' (line 14): warning: the joint has no <axis>; 1 0 0 is taken; write <axis xyz=\"1 0 0\"/>"},
    {"point_mass",
     "link 'b' (line 8): warning: the link has a mass but no rotational inertia: a point mass; give <inertia> if it has an extent"},
    {"point_mass_on_axis",
     "link 'b' (line 8): warning: the link has a mass but no rotational inertia: a point mass; give <inertia> if it has an extent\n"
     "joint 'j': warning: link 'b' has no inertia about the joint's axis: M is singular; give the link a rotational inertia, or the joint an armature in the scene"},
    {"triangle_inequality",
     "link 'b' (line 8): warning: the inertia breaks the triangle inequality by 0.5 kg m² (principal moments 1, 1, 2.5 kg m²); no body has such an inertia: no principal moment exceeds the sum of the others; it is used as given"},
    {"two_axes",
     "joint 'j' (line 17): warning: a second <axis> in <joint> is ignored; keep one of them"},
    {"unknown_attribute",
     "joint 'j' (line 18): warning: unknown attribute 'xzy' of <origin> is ignored; the known ones are xyz, rpy"},
    {"unknown_tags",
     "robot 'r' (line 20): warning: unknown element <loop> in <robot> is ignored; the known ones are link, joint, material, transmission, gazebo, sensor, mujoco, plugin\n"
     "link 'b' (line 10): warning: unknown element <density> in <inertial> is ignored; the known ones are origin, mass, inertia\n"
     "joint 'j' (line 18): warning: unknown element <gear> in <joint> is ignored; the known ones are origin, parent, child, axis, limit, dynamics, mimic, calibration, safety_controller, gazebo, sensor, hardwareInterface"},
};
// clang-format on

class Defect : public testing::TestWithParam<Case> {};
class Doubt : public testing::TestWithParam<Case> {};

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
  EXPECT_EQ(run.err, expected(GetParam()));
  EXPECT_NE(run.out.find("robot r (r)"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Urdf, Defect, testing::ValuesIn(defects), name_of);
INSTANTIATE_TEST_SUITE_P(Urdf, Doubt, testing::ValuesIn(doubts), name_of);

// The robot all the others are made from, by one defect each, is read without a word.
TEST(Urdf, SoundRobotIsReadInSilence) {
  const Outcome run = run_dalembert({"info", "sound.urdf"}, ERROR_ROBOTS);
  EXPECT_EQ(run.status, 0);
  EXPECT_EQ(run.err, "");
}

// Every file here is in one of the tables.
TEST(Urdf, EveryFileIsTested) {
  size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(ERROR_ROBOTS)) files += entry.path().extension() == ".urdf";
  EXPECT_EQ(files, std::size(defects) + std::size(doubts) + 1);
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
