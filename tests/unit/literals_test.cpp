// Numbers, and names of joints and links, as C++ literals.
#include "backend/literals.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "diagnostics.hpp"

namespace dalembert::backend {
namespace {

TEST(Literal, IsANumberOfItsType) {
  EXPECT_EQ(literal(2, ir::ScalarType::float64), "2.0");
  EXPECT_EQ(literal(0.1, ir::ScalarType::float32), "0.1f");
  EXPECT_EQ(literal(1e39, ir::ScalarType::float64), "1e+39");
  EXPECT_THROW(literal(1e39, ir::ScalarType::float32), InputError);
  for (const double none : {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(literal(none, ir::ScalarType::float64), InputError);
}

TEST(Quoted, EscapesWhatEndsALiteralOrBeginsATrigraph) {
  EXPECT_EQ(quoted("left-arm 2?"), R"("left-arm 2?")");
  EXPECT_EQ(quoted("a\"b\\c\n"), R"("a\"b\\c\012")");
  EXPECT_EQ(quoted("what?\?/"), R"("what?\?/")");
  EXPECT_EQ(quoted("a\u202e\u2067b\u2019"), R"("a\342\200\256\342\201\247b’")");
}

TEST(CommentText, NeitherContinuesItsLineNorTurnsIt) {
  EXPECT_EQ(comment_text("left arm\\\\"), "left arm");
  EXPECT_EQ(comment_text("why?\?/"), "why? ?/");
  EXPECT_EQ(comment_text("a\tb\nc"), "a b c");
  EXPECT_EQ(comment_text("a\u202e\u2067b\u2019"), "ab’");
  EXPECT_EQ(comment_lines("of tip?\?/", 0), "// of tip? ?/\n");
}

}  // namespace
}  // namespace dalembert::backend
