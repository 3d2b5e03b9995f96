// The report's table and its measures of error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "commands/report/errors.hpp"
#include "commands/report/progress.hpp"
#include "commands/report/rounding.hpp"
#include "commands/report/rows.hpp"
#include "commands/report/task_graph.hpp"
#include "commands/report/verdict.hpp"
#include "commands/timing.hpp"

namespace dalembert::reporting {
namespace {

TEST(ReportRows, QuoteWhatCsvSeparatesWith) {
  Rows rows;
  rows.number("rounding", "random states", "mass_matrix", "rolled double, 4 lanes", "time_median", 0.1, "ns");
  rows.text("robot", "a \"b\"", "", "", "base", "two\nlines");
  EXPECT_EQ(rows.csv(),
            "section,case,quantity,variant,metric,value,unit\n"
            "rounding,random states,mass_matrix,\"rolled double, 4 lanes\",time_median,0.1,ns\n"
            "robot,\"a \"\"b\"\"\",,,base,\"two\nlines\",\n");
}

TEST(ReportVerdict, FallsOnWhatATaskGraphChanges) {
  for (const double changed : {0.0, 3.0}) {
    Rows rows;
    rows.number("rounding", "random states", "all", task_graph_variant, "elements_changed", changed, "elements");
    EXPECT_EQ(add_verdict(rows), changed == 0);
    EXPECT_EQ(rows.csv().find("The task graph changes 3 elements") != std::string::npos, changed != 0);
  }
}

TEST(ReportVerdict, SaysWhatGoesBadlyByWhatWasViolated) {
  Rows rows;
  rows.number("stability", "base at 1e12 m", "gravity", "generated double", "elements_changed", 3, "elements");
  rows.text("stability", "base at 1e12 m", "gravity", "generated double", "verdict", "bad");
  rows.text("stability", "base at 1e12 m", "gravity", "generated double", "violated",
            "does not read it, yet 3 elements change");
  EXPECT_FALSE(add_verdict(rows));
  EXPECT_NE(rows.csv().find("Goes badly in double: base at 1e12 m (gravity: does not read it, yet 3 elements change)."),
            std::string::npos)
      << rows.csv();
}

// Against the fastest other program of each quantity, never against our own reference.
TEST(ReportVerdict, IsAgainstTheBestPeer) {
  Rows rows;
  const auto quantity = [&](const char* name, double pinocchio, double mujoco) {
    rows.text("rounding", random_case, name, "straight double", "chosen", "yes");
    const auto add = [&](const char* metric, double value, const char* unit) {
      if (value > 0) rows.number("rounding", random_case, name, "straight double", metric, value, unit);
    };
    add("time_median", 1150, "ns");
    add("times_faster", 63, "times");
    add("times_faster_than_pinocchio", pinocchio, "times");
    add("times_faster_than_mujoco", mujoco, "times");
  };
  const auto said = [&](const char* metric) {
    add_verdict(rows);
    for (const Row& row : rows.all())
      if (row.section == "verdict" && row.metric == metric) return row.value;
    return std::string();
  };
  quantity("coriolis_matrix", 0, 0);
  EXPECT_EQ(said("beside_peers"), "") << "there is none";
  rows = {};
  quantity("mass_matrix", 0, 12.5);
  EXPECT_EQ(said("beside_peers"), "12.5 times as fast as MuJoCo (M).");
  quantity("gravity", 9.25, 20);
  quantity("bias", 7.5, 3.25);
  rows.text("stability", "base at 1e12 m", "gravity", "generated double", "violated", "it changes");
  Rows fresh = rows;
  add_verdict(fresh);
  std::vector<std::string> sentences;
  for (const Row& row : fresh.all())
    if (row.section == "verdict" && row.value.find("12.5 times as fast as MuJoCo (M).") == std::string::npos)
      sentences.push_back(row.value);
  EXPECT_NE(std::find(sentences.begin(), sentences.end(),
                      "3.25 (C v + g) to 12.5 (M) times as fast as the faster of Pinocchio and MuJoCo."),
            sentences.end())
      << fresh.csv();
  EXPECT_EQ(fresh.csv().find("63 times"), std::string::npos);
  EXPECT_NE(fresh.csv().find("1.15 µs a call"), std::string::npos) << fresh.csv();
}

TEST(ReportProgress, TellsWhatIsLeftOnceItKnows) {
  EXPECT_EQ(time_left(0.5, 1, 10), "");
  EXPECT_EQ(time_left(30, 0, 10), "");
  EXPECT_EQ(time_left(30, 10, 10), "");
  EXPECT_EQ(time_left(30, 5, 10), ", about 30 s left");
  EXPECT_EQ(time_left(60, 5, 50), ", about 9 min left");
}

TEST(Timing, IsToldInTheUnitThatLeavesNoFourthDigit) {
  EXPECT_EQ(time_text(0.5), "0.5 ns");
  EXPECT_EQ(time_text(999.4), "999 ns");
  EXPECT_EQ(time_text(999.6), "1 µs");
  EXPECT_EQ(time_text(1150), "1.15 µs");
  EXPECT_EQ(time_text(2.5e7), "25 ms");
}

TEST(ReportErrors, ChangesAreCountedByTheBitAndMeasuredInTheLastPlaceOfTheLargest) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  Eigen::MatrixXd before(2, 2), after(2, 2);
  before << 1, 0, 0.25, nan;
  after << 1, -0.0, 0.25, nan;
  EXPECT_EQ(change_between(before, after, ir::ScalarType::float64).elements, 0);
  after(1, 0) = 0.25 + 0x1p-51;
  const Change one = change_between(before, after, ir::ScalarType::float64);
  EXPECT_EQ(one.elements, 1);
  EXPECT_EQ(one.ulp, 2);
  EXPECT_EQ(one.told(), "1 element changes by up to 2 ulp of the largest");
  after(0, 0) = 1 + 0x1p-22;
  const Change two = change_between(before, after, ir::ScalarType::float32);
  EXPECT_EQ(two.told(), "2 elements change by up to 2 ulp of the largest");
  after(0, 1) = nan;
  EXPECT_EQ(change_between(before, after, ir::ScalarType::float64).told(), "3 elements change from a number to none or back");
}

TEST(ReportErrors, AreRelativeToTheLargestElementToItsLastPlaceAndToEachElement) {
  Eigen::MatrixXd exact(2, 2), result(2, 2);
  exact << 1, 0, 0x1p-10, -0.5;
  result << 1, 0x1p-52, 0x1.01p-10, -0.5;
  const Error error = error_of(result, exact, 0, ir::ScalarType::float64);
  EXPECT_EQ(error.norm, 0x1p-18);
  EXPECT_EQ(error.ulp, 0x1p34);
  EXPECT_EQ(error.component, 0x1p-8);
  EXPECT_EQ(error_of(result, exact, 0, ir::ScalarType::float32).ulp, 0x1p5);
  EXPECT_EQ(error_of(result, exact, 4, ir::ScalarType::float64).norm, 0x1p-20);
}

TEST(ReportErrors, OfWhatIsNotFiniteAreInfiniteOrUnknown) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1), nan = one * std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(error_of(nan, one, 0, ir::ScalarType::float64).ulp, std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(error_of(one, nan, 0, ir::ScalarType::float64).ulp));
  EXPECT_EQ(error_of(0 * one, 0 * one, 0, ir::ScalarType::float64).ulp, 0);
}

TEST(ReportErrors, SpreadByRank) {
  const Spread s = spread({5, 1, 4, 2, 3});
  EXPECT_EQ(s.lower_quartile, 2);
  EXPECT_EQ(s.median, 3);
  EXPECT_EQ(s.upper_quartile, 4);
  EXPECT_EQ(s.worst, 5);
}

}  // namespace
}  // namespace dalembert::reporting
