// What `dalembert calibrate` keeps, and what --calibrated makes of it.
#include "commands/calibrate.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "backend/estimate.hpp"
#include "compile.hpp"
#include "lower.hpp"

namespace dalembert {
namespace {

ir::MachineCosts costs_of_lanes(int lanes, double speed) {
  ir::MachineCosts costs{"a \"machine\": 1", "c++ -O3", lanes, {}, {300, 200}};
  for (const double x : backend::committed_constants(lanes)) costs.per_feature.push_back(x / speed);
  return costs;
}

TEST(Calibrate, KeepsWhatItMeasured) {
  const ir::MachineCosts costs = costs_of_lanes(8, 3), read = costs_of_text(costs_text(costs), "file");
  EXPECT_EQ(read.machine, costs.machine);
  EXPECT_EQ(read.compiler, costs.compiler);
  EXPECT_EQ(read.lanes, 8);
  EXPECT_EQ(read.threads.coming, 300);
  EXPECT_EQ(read.threads.parting, 200);
  ASSERT_EQ(read.per_feature.size(), costs.per_feature.size());
  for (size_t f = 0; f < read.per_feature.size(); ++f)
    EXPECT_NEAR(read.per_feature[f], costs.per_feature[f], 1e-5 * costs.per_feature[f]);
}

TEST(Calibrate, RefusesWhatItDidNotWrite) {
  const std::string good = costs_text(costs_of_lanes(4, 1));
  const auto without = [&](const std::string& what, const std::string& instead) {
    std::string text = good;
    return text.replace(text.find(what), what.size(), instead);
  };
  EXPECT_NO_THROW(costs_of_text(good, "file"));
  for (const std::string& text :
       {std::string(), std::string("- 1\n"), std::string("a: [\n"), without("scalar: ", "scaled: "),
        without("coming: ", "coming: -"), without("coming: ", "coming: x"), without("register: 4", "register: 3")})
    EXPECT_THROW(costs_of_text(text, "file"), InputError) << text;
}

// A machine three times as fast is expected to take a third, and with cheaper threads to gain more by them.
TEST(Calibrate, IsWhatChoicesGoBy) {
  Request request;
  request.robot = ROBOT;
  request.settings = {{"base", "fixed"}, {"outputs", "mass_matrix,coriolis_matrix"}, {"parallel", "tasks"}};
  request.form = "rolled";
  Diagnostics warnings;
  const Model committed = read_model(request, warnings);
  ir::MachineCosts costs = costs_of_lanes(4, 3);
  costs.threads = {0, 0};
  request.costs = std::make_shared<ir::MachineCosts>(costs);
  const Model measured = read_model(request, warnings);
  const FunctionTasks before = tasks_of_functions(committed, lower(committed)).front(),
                      after = tasks_of_functions(measured, lower(measured)).front();
  EXPECT_EQ(after.lanes, 4);
  EXPECT_NEAR(ir::serial_time(before.plan), 3 * ir::serial_time(after.plan), 1e-9 * ir::serial_time(before.plan));
  EXPECT_NE(measured.command_line.find("--calibrated"), std::string::npos);
  EXPECT_EQ(committed.command_line.find("--calibrated"), std::string::npos);
}

}  // namespace
}  // namespace dalembert
