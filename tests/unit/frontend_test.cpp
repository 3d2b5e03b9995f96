// The front end's small parts, and reading in a locale whose decimal point is a comma.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <locale>
#include <memory>
#include <string>

#include "frontend/nearest.hpp"
#include "frontend/numbers.hpp"
#include "frontend/scene_check.hpp"
#include "frontend/text_encoding.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/identifier.hpp"
#include "ir/library_names.hpp"

namespace dalembert {
namespace {

TEST(Numbers, AreReadWholeOrNotAtAll) {
  EXPECT_EQ(frontend::parse_number(" -1.5e-3\n"), -1.5e-3);
  EXPECT_EQ(frontend::parse_number("+2"), 2);
  EXPECT_EQ(frontend::parse_number(".5"), 0.5);
  EXPECT_EQ(frontend::parse_number("5."), 5);
  EXPECT_EQ(frontend::parse_number("\t1E+2\r\n"), 100);
  EXPECT_EQ(frontend::parse_number("5e-324"), 5e-324);
  const std::string zeros(400, '0');
  for (const std::string& tiny : std::vector<std::string>{"1e-999", "-0.0001e-400", "0." + zeros + "1", "1" + zeros + "e-9999",
                                                          "0." + zeros + "1e10", "1e-99999999999999999999"})
    EXPECT_EQ(frontend::parse_number(tiny), 0) << tiny;
  for (const std::string& huge : std::vector<std::string>{"1e999", "1" + zeros, "-1e999", "0.001e999", "1" + zeros + "e-10",
                                                          "0." + zeros + "1e9999", "1e99999999999999999999", "1e999e-999"})
    EXPECT_EQ(frontend::parse_number(huge), std::nullopt) << huge;
  EXPECT_TRUE(std::isnan(*frontend::parse_number("nan")));
  EXPECT_TRUE(std::isinf(*frontend::parse_number("-inf")));
  for (const char* text :
       {"", " ", "1,5", "1.5kg", "0x10", "1e-3f", "1 2", "--1", "+-1", "1e", ".", "1e-999f", "e5", "1_0", "0b1"})
    EXPECT_EQ(frontend::parse_number(text), std::nullopt) << text;
  EXPECT_EQ(frontend::parse_numbers("1\t2  3"), (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(frontend::parse_numbers(""), std::vector<double>{});
  EXPECT_EQ(frontend::parse_numbers("1 two"), std::nullopt);
}

struct Comma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
};

TEST(Numbers, ReadAlikeInEveryLocale) {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new Comma));
  Diagnostics warnings;
  const ir::RobotDescription robot = frontend::read_urdf_text("r.urdf", R"(<robot name="r">
    <link name="a"><inertial><origin xyz="0.5 0 0"/><mass value="1.5"/>
      <inertia ixx="1.25" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>)",
                                                              warnings);
  std::locale::global(before);
  EXPECT_EQ(robot.links[0].inertia->mass, 1.5);
  EXPECT_EQ(robot.links[0].inertia->com.x(), 0.5);
  EXPECT_EQ(robot.links[0].inertia->inertia(0, 0), 1.25);
}

TEST(Nearest, SuggestsOneCloseNameOrListsThem) {
  EXPECT_EQ(frontend::suggestion("l_kne", {"l_knee", "r_knee"}), "did you mean 'l_knee'?");
  EXPECT_EQ(frontend::suggestion("L_KNEE", {"r_hip", "l_knee"}), "did you mean 'l_knee'?");
  EXPECT_EQ(frontend::suggestion("wheel", {"l_knee", "r_knee"}), "choose from l_knee, r_knee");
  EXPECT_EQ(frontend::suggestion("x", {}), "there is none to choose from");
}

TEST(Identifier, KeepsWhatItCan) {
  EXPECT_EQ(ir::identifier("l_knee2"), "l_knee2");
  EXPECT_EQ(ir::identifier("/j1"), "_j1");
  EXPECT_EQ(ir::identifier("left-arm 2"), "left_arm_2");
  EXPECT_EQ(ir::identifier("3dof"), "_3dof");
  EXPECT_EQ(ir::identifier("bras gauché"), "bras_gauch__");  // each byte of UTF-8
  EXPECT_EQ(ir::identifier(""), "_");
  for (const char* keyword : {"alignas", "class", "co_await", "int", "xor_eq", "char8_t", "requires"})
    EXPECT_TRUE(ir::is_cpp_keyword(keyword)) << keyword;
  for (const char* name : {"", "Class", "integer", "hip", "zzz"}) EXPECT_FALSE(ir::is_cpp_keyword(name)) << name;
}

// Joints' names are enumerators: none may be a macro where a user's program includes the code. As this compiler sees the
// headers.
TEST(LibraryNames, CompriseEveryMacroOfTheHeaders) {
  for (const std::string language : {"gnu++17", "gnu++20"}) {
    const std::string command =
        std::string(COMPILER) + " -std=" + language +
        " -dM -E -x c++ -I" EIGEN
        " -include Eigen/Dense -include oneapi/tbb.h -include cmath -include csignal -include cstdio -include unistd.h"
        " -include sys/mman.h -include ctime /dev/null";
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> all(popen(command.c_str(), "r"), pclose);
    ASSERT_TRUE(all);
    char line[4096], name[4096];
    int macros = 0;
    while (std::fgets(line, sizeof line, all.get()))
      if (std::sscanf(line, "#define %[A-Za-z0-9_(]", name) == 1 && name[0] != '_' &&
          std::string(name).find('(') == std::string::npos) {
        ++macros;
        EXPECT_TRUE(ir::is_library_macro(name)) << name;
      }
    EXPECT_GT(macros, 500) << language;
  }
  for (const char* predefined : {"__LINE__", "__linux__", "__cplusplus"})
    EXPECT_TRUE(ir::is_library_macro(predefined)) << predefined;
  for (const char* joint : {"_1", "__", "__left", "LF_HAA", "J1", "E1"}) EXPECT_FALSE(ir::is_library_macro(joint)) << joint;
}

TEST(LibraryNames, CompriseFunctionsTypesAndConstants) {
  for (const char* taken :
       {"sin", "sinf", "strtok_r", "tm", "timespec", "FILE", "size_t", "ptrdiff_t", "int32_t", "uint_fast8_t", "time_t",
        "div_t", "double_t", "pthread_t", "sigaction", "siginfo_t", "off_t", "sched_param", "uint"})
    EXPECT_TRUE(ir::is_library_name(taken)) << taken;
  for (const char* robot :
       {"arm", "arm_t", "robot_t", "wolf", "golf", "panel", "model", "mahru", "scara", "link_l", "index_r", "t", "f"})
    EXPECT_FALSE(ir::is_library_name(robot)) << robot;
}

TEST(Text, IsMadeUtf8) {
  EXPECT_EQ(frontend::as_utf8("gauch\xc3\xa9"), "gauch\xc3\xa9");
  EXPECT_EQ(frontend::as_utf8("gauch\xe9"), "gauch\xc3\xa9");                  // ISO 8859-1
  EXPECT_EQ(frontend::as_utf8("a\xed\xa0\x80"), "a\xc3\xad\xc2\xa0\xc2\x80");  // half of a pair is no UTF-8
  EXPECT_EQ(frontend::as_utf8("\xef\xbb\xbfgauch\xc3\xa9"), "gauch\xc3\xa9");  // marked
  EXPECT_EQ(frontend::as_utf8("\xef\xbb\xbfgauch\xe9"), "gauch\xc3\xa9");      // wrongly
  const std::string little("\xff\xfe<\0\xe9\0\x3d\xd8\x00\xde", 10), big("\xfe\xff\0<\0\xe9\xd8\x3d\xde\x00", 10);
  EXPECT_EQ(frontend::as_utf8(little), "<\xc3\xa9\xf0\x9f\x98\x80");
  EXPECT_EQ(frontend::as_utf8(big), "<\xc3\xa9\xf0\x9f\x98\x80");
  EXPECT_EQ(frontend::as_utf8(std::string("\xff\xfe<", 3)), "");
}

TEST(Diagnostics, WarningsOfAKindAreToldOnceAndErrorsNeverLeftOut) {
  const auto diagnostic = [](Severity severity, const char* element, const char* message, const char* kind) {
    return Diagnostic{severity, "f", element, message, "", kind};
  };
  const Diagnostics all{diagnostic(Severity::warning, "a", "odd", ""),  diagnostic(Severity::warning, "b", "by 1", "k"),
                        diagnostic(Severity::error, "c", "odd", ""),    diagnostic(Severity::error, "d", "odd", ""),
                        diagnostic(Severity::warning, "e", "odd", ""),  diagnostic(Severity::warning, "g", "by 2", "k"),
                        diagnostic(Severity::warning, "h", "other", "")};
  EXPECT_EQ(lines(all, false),
            (std::vector<std::string>{"f: a: warning: odd (the first of 2 such warnings; --verbose shows all)",
                                      "f: b: warning: by 1 (the first of 2 such warnings; --verbose shows all)",
                                      "f: c: error: odd", "f: d: error: odd", "f: h: warning: other"}));
  EXPECT_EQ(lines(all, true).size(), all.size());
}

ir::Base default_base(const std::string& links_and_joints) {
  Diagnostics warnings;
  return frontend::default_base(
      frontend::read_urdf_text("r.urdf", "<robot name='r'>" + links_and_joints + "</robot>", warnings));
}

TEST(DefaultBase, FloatsUnlessTheRootIsTheWorldOrWithoutInertia) {
  const auto link = [](const std::string& name) {
    return "<link name='" + name +
           "'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>";
  };
  const auto joint = [](const std::string& type) {
    return "<joint name='j' type='" + type + "'><parent link='root'/><child link='b'/><axis xyz='1 0 0'/></joint>";
  };
  EXPECT_EQ(default_base(link("root") + link("b") + joint("revolute")), ir::Base::floating);
  EXPECT_EQ(default_base(link("world")), ir::Base::fixed);
  EXPECT_EQ(default_base("<link name='root'/>" + link("b") + joint("revolute")), ir::Base::fixed);
  EXPECT_EQ(default_base("<link name='root'/>" + link("b") + joint("fixed")), ir::Base::floating);
  EXPECT_EQ(default_base("<link name='root'/><link name='b'/>" + joint("floating")), ir::Base::floating);
  EXPECT_EQ(default_base(link("b") + "<joint name='j' type='fixed'><parent link='world'/><child link='b'/></joint>"),
            ir::Base::fixed);
}

TEST(UrdfReader, PassesOverGeometryAndMissingLimits) {
  Diagnostics warnings;
  frontend::read_urdf_text("r.urdf", R"(<robot name="r" version="7">
    <material name="m"><color rgba="broken"/></material><transmission/><gazebo reference="x"><nan/></gazebo>
    <link name="a"><visual><geometry><mesh/></geometry></visual><collision><origin xyz="a b c"/></collision></link>
    <link name="b"/><joint name="j" type="prismatic"><parent link="a"/><child link="b"/><axis xyz="1 0 0"/></joint>
    <drake:declare_convex xmlns:drake="d"/></robot>)",
                           warnings);
  EXPECT_TRUE(warnings.empty()) << to_string(warnings.front());
}

// Each answered with the right name, and where two are as right with both.
TEST(Suggestion, FindsWhatWasMeant) {
  const std::vector<std::string> quantities{"mass_matrix",
                                            "coriolis_matrix",
                                            "gravity",
                                            "bias",
                                            "wrench_influence",
                                            "kinetic_energy",
                                            "potential_energy",
                                            "center_of_mass",
                                            "center_of_mass_jacobian",
                                            "momentum_matrix",
                                            "momentum_bias",
                                            "inverse_mass_matrix",
                                            "mass_matrix_factor",
                                            "inverse_dynamics",
                                            "inverse_dynamics_dq",
                                            "inverse_dynamics_dv",
                                            "regressor",
                                            "forward_dynamics",
                                            "forward_dynamics_dq",
                                            "forward_dynamics_dv",
                                            "constrained_forward_dynamics",
                                            "constraint_forces",
                                            "constraint_jacobian",
                                            "delassus_matrix",
                                            "impact",
                                            "crba",
                                            "rnea",
                                            "aba",
                                            "com",
                                            "com_jacobian"},
      links{"base",       "head",      "left_foot",         "right_foot",         "left_hand",
            "right_hand", "left_shin", "left_hip_yaw_link", "right_hip_yaw_link", "left_shoulder_pitch_link"},
      renamed{"foot-b", "foot_b_"}, joints{"waist",     "left_hip_yaw", "left_hip_roll", "left_hip_pitch",
                                           "left_knee", "right_knee",   "left_elbow",    "right_elbow"},
      keys{"gravity", "outputs", "locked", "frames", "payloads", "wrenches", "contacts", "damping", "friction", "armature"};
  struct Misspelt {
    const char* name;
    const std::vector<std::string>& among;
    const char* meant;
  };
  const Misspelt all[] = {{"mass_matirx", quantities, "'mass_matrix'"},
                          {"massmatrix", quantities, "'mass_matrix'"},
                          {"MassMatrix", quantities, "'mass_matrix'"},
                          {"mass-matrix", quantities, "'mass_matrix'"},
                          {"mass", quantities, "'mass_matrix' or 'center_of_mass'"},
                          {"coriolis", quantities, "'coriolis_matrix'"},
                          {"coriolis_matirx", quantities, "'coriolis_matrix'"},
                          {"gravty", quantities, "'gravity'"},
                          {"gravity_vector", quantities, "'gravity'"},
                          {"forward_dynamic", quantities, "'forward_dynamics'"},
                          {"forwad_dynamics", quantities, "'forward_dynamics'"},
                          {"fwd_dynamics", quantities, "'forward_dynamics'"},
                          {"inv_dynamics", quantities, "'inverse_dynamics'"},
                          {"dynamics_inverse", quantities, "'inverse_dynamics'"},
                          {"inverse_dynamics_dq_dv", quantities, "'inverse_dynamics_dq' or 'inverse_dynamics'"},
                          {"centre_of_mass", quantities, "'center_of_mass'"},
                          {"center_mass", quantities, "'center_of_mass'"},
                          {"com_jac", quantities, "'com_jacobian'"},
                          {"momentum", quantities, "'momentum_bias' or 'momentum_matrix'"},
                          {"energy_kinetic", quantities, "'kinetic_energy'"},
                          {"potental_energy", quantities, "'potential_energy'"},
                          {"rnae", quantities, "'rnea'"},
                          {"cbra", quantities, "'crba'"},
                          {"mass_matrix_inverse", quantities, "'inverse_mass_matrix'"},
                          {"regresor", quantities, "'regressor'"},
                          {"constrained_dynamics", quantities, "'constrained_forward_dynamics'"},
                          {"constraint_force", quantities, "'constraint_forces'"},
                          {"delassus", quantities, "'delassus_matrix'"},
                          {"foot_b", renamed, "'foot_b_'"},
                          {"foot", links, "'left_foot' or 'right_foot'"},
                          {"lfoot", links, "'left_foot'"},
                          {"l_foot", links, "'left_foot'"},
                          {"foot_left", links, "'left_foot'"},
                          {"LeftFoot", links, "'left_foot'"},
                          {"left_foot_link", links, "'left_foot'"},
                          {"left_hip_link", links, "'left_hip_yaw_link'"},
                          {"rigth_hand", links, "'right_hand'"},
                          {"left_shoulder", links, "'left_shoulder_pitch_link'"},
                          {"knee", joints, "'left_knee' or 'right_knee'"},
                          {"lknee", joints, "'left_knee'"},
                          {"left_hip", joints, "'left_hip_yaw' or 'left_hip_roll' or 'left_hip_pitch'"},
                          {"hip_yaw_left", joints, "'left_hip_yaw'"},
                          {"left_knee_joint", joints, "'left_knee'"},
                          {"rigth_elbow", joints, "'right_elbow'"},
                          {"frame", keys, "'frames'"},
                          {"lock", keys, "'locked'"},
                          {"joint_damping", keys, "'damping'"},
                          {"external_wrenches", keys, "'wrenches'"}};
  static_assert(std::size(all) >= 40);
  for (const Misspelt& one : all)
    EXPECT_EQ(frontend::suggestion(one.name, one.among), std::string("did you mean ") + one.meant + "?") << one.name;
  EXPECT_EQ(frontend::suggestion("colour", keys).substr(0, 12), "choose from ");
  EXPECT_EQ(frontend::suggestion("", {}), "there is none to choose from");
}

}  // namespace
}  // namespace dalembert
