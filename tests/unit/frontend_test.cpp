// The front end's small parts, and reading in a locale whose decimal point is a comma.
#include <gtest/gtest.h>

#include <cmath>
#include <locale>

#include "frontend/nearest.hpp"
#include "frontend/numbers.hpp"
#include "frontend/scene_check.hpp"
#include "frontend/urdf_reader.hpp"
#include "ir/identifier.hpp"

namespace dalembert {
namespace {

TEST(Numbers, AreReadWholeOrNotAtAll) {
  EXPECT_EQ(frontend::parse_number(" -1.5e-3\n"), -1.5e-3);
  EXPECT_EQ(frontend::parse_number("+2"), 2);
  EXPECT_EQ(frontend::parse_number("1e-999"), 0);
  EXPECT_TRUE(std::isnan(*frontend::parse_number("nan")));
  EXPECT_TRUE(std::isinf(*frontend::parse_number("-inf")));
  for (const char* text : {"", " ", "1,5", "1.5kg", "0x10", "1e999", "1 2", "--1", "+-1", "1e", "."})
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

}  // namespace
}  // namespace dalembert
