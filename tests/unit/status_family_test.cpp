// Where ok ends as a robot nears a singular M: no v̇ and no M⁻¹ that is ok has less than a right digit, and M of condition 1e12
// still is ok.
#include <gtest/gtest.h>

#include "both_forms.hpp"
#include "frontend/urdf_reader.hpp"
#include "status_measured.hpp"

namespace dalembert {
namespace {

using status_family::Measured;
using status_family::Shape;
using status_family::Way;

bool in_float(const Way& way) { return way.name.find("float") != std::string::npos; }

class StatusFamily : public testing::TestWithParam<Shape> {};

TEST_P(StatusFamily, IsOkWhereDigitsAreRight) {
  int ok = 0, singular = 0;
  for (const double distance : {1.0, 0.2, 0.06, 1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-11, 1e-16}) {
    const Measured measured = status_family::measure(GetParam(), distance, 1);
    SCOPED_TRACE(GetParam().name + " at " + std::to_string(distance));
    for (const Way& way : measured.ways) {
      SCOPED_TRACE(way.name);
      ++(way.ok ? ok : singular);
      if (way.ok) {
        EXPECT_TRUE(measured.exact);
        EXPECT_GE(way.digits, 1) << measured.condition;
      }
      EXPECT_TRUE(way.ok || measured.condition > (in_float(way) ? 1e4 : 1e12)) << measured.condition;
      EXPECT_FALSE(way.ok && measured.condition > (in_float(way) ? 1e7 : 1e15)) << measured.condition;
    }
    // Ways agree in which coordinate moves nothing where there is no doubt of it.
    if (measured.condition < 1e16) continue;
    const int first = GetParam().before + (GetParam().floating ? 6 : 0);
    for (const Way& way : measured.ways)
      if (way.coordinate >= 0) {
        EXPECT_GE(way.coordinate, GetParam().floating ? 0 : first) << way.name;
        EXPECT_LT(way.coordinate, first + GetParam().joints - 1) << way.name;
      }
  }
  // A body has six ways to move: of seven joints with no mass between them M is singular wherever they are.
  if (GetParam().joints > 6 && GetParam().between == 0) {
    EXPECT_EQ(ok, 0);
  } else {
    EXPECT_GT(ok, 20);
  }
  EXPECT_GT(singular, GetParam().between > 0 ? 10 : 20);  // what stands between the joints keeps M from being singular
}

INSTANTIATE_TEST_SUITE_P(Shapes, StatusFamily, testing::ValuesIn(status_family::shapes()),
                         [](const auto& info) { return info.param.name; });

// A neck as public robots have it: three axes that are parallel but for the digits that rpy is written with move one point
// mass. At its zero pose v̇ was 1e18 rad/s² once, and ok.
TEST(Status, OfANeckOfParallelAxesIsNotOk) {
  const std::string neck = R"(<robot name="neck">
    <link name="chest"/>
    <link name="waist"><inertial><origin xyz="0 0.02 0.1"/><mass value="4"/>
      <inertia ixx="0.05" iyy="0.04" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <link name="lower"/><link name="middle"/>
    <link name="head"><inertial><origin xyz="0.03 0.05 0"/><mass value="0.8"/>
      <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="turn" type="revolute"><parent link="chest"/><child link="waist"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <joint name="pitch" type="revolute"><parent link="waist"/><child link="lower"/><origin xyz="0.01 0 0.3" rpy="1.57079633 0 0"/>
      <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <joint name="roll" type="revolute"><parent link="lower"/><child link="middle"/><origin xyz="0.033 0 0" rpy="1.57079632 0 0"/>
      <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <joint name="yaw" type="revolute"><parent link="middle"/><child link="head"/><origin xyz="0 0.02 0.01" rpy="-1.570796327 0 0"/>
      <axis xyz="0 0 -1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)";
  Diagnostics warnings;
  const Model model = model_of(frontend::read_urdf_text("neck.urdf", neck, warnings), {});
  State state = some_state(model.tree);
  for (const bool bent : {false, true}) {
    state.q.setZero();
    for (int i = 0; i < model.tree.joints() && bent; ++i) state.q[model.tree.nq() - model.tree.joints() + i] = 0.3;
    ir::EmittedFunction own = ir::standard_function(ir::Function::forward_dynamics);
    own.quantities = {ir::Quantity::forward_dynamics};
    for (const ir::Solver solver : {ir::Solver::articulated_bodies, ir::Solver::factorization})
      for (const ir::Arrays& form : run_function(own, model, state, {}, {}, solver)) {
        EXPECT_EQ(form.at("status")(0, 0), model.tree.nv() - 3) << bent;
        EXPECT_EQ(form.at("forward_dynamics").cwiseAbs().maxCoeff(), 0);
      }
  }
}

// Two slides that are parallel but for such digits: all numbers are constants, and what the first has to be divided by is a
// zero that stands nowhere.
TEST(Status, OfConstantsThatLeaveNothingIsNotOk) {
  const std::string slides = R"(<robot name="slides"><link name="base"/><link name="between"/>
    <link name="end"><inertial><mass value="2"/><inertia ixx="0.01" iyy="0.03" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="one" type="prismatic"><parent link="base"/><child link="between"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
    <joint name="other" type="prismatic"><parent link="between"/><child link="end"/><origin rpy="1e-9 0 0"/><axis xyz="0 0 1"/>
      <limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)";
  Diagnostics warnings;
  ir::Scene scene;
  scene.base = ir::Base::fixed;
  const Model model = model_of(frontend::read_urdf_text("slides.urdf", slides, warnings), scene);
  for (const auto& [function, quantity] : {std::pair{ir::Function::forward_dynamics, ir::Quantity::forward_dynamics},
                                           std::pair{ir::Function::evaluate, ir::Quantity::inverse_mass_matrix}}) {
    ir::EmittedFunction own = ir::standard_function(function);
    own.quantities = {quantity};
    for (const ir::Solver solver : {ir::Solver::articulated_bodies, ir::Solver::factorization})
      for (const ir::Arrays& form : run_function(own, model, some_state(model.tree), {}, {}, solver)) {
        EXPECT_GE(form.at("status")(0, 0), 0) << own.result(quantity);
        EXPECT_EQ(form.at(own.result(quantity)).cwiseAbs().maxCoeff(), 0) << own.result(quantity);
      }
  }
}

}  // namespace
}  // namespace dalembert
