// Names of joints and links as C++ string literals.
#include "backend/literals.hpp"

#include <gtest/gtest.h>

namespace dalembert::backend {
namespace {

TEST(Quoted, EscapesWhatEndsALiteralOrBeginsATrigraph) {
  EXPECT_EQ(quoted("left-arm 2?"), R"("left-arm 2?")");
  EXPECT_EQ(quoted("a\"b\\c\n"), R"("a\"b\\c\012")");
  EXPECT_EQ(quoted("what?\?/"), R"("what?\?/")");
}

}  // namespace
}  // namespace dalembert::backend
