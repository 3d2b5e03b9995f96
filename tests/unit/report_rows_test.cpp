// The report's table and its measures of error.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "commands/report/errors.hpp"
#include "commands/report/rows.hpp"
#include "commands/report/task_graph.hpp"
#include "commands/report/verdict.hpp"

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
