// The self-test of generated code: results of a few states compared with what the generator computed in many digits.
//
// Nothing here allocates, locks, throws or calls the system, but for describe(), which prints into the caller's buffer.
// A result that is not finite is seen by its bits: code compiled with -ffast-math must not take NaN for agreement.
#pragma once

#include <cfloat>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace dalembert {

// The element that is worst, relative to what it is allowed; of a failed test one that is wrong.
struct SelfTestReport {
  const char* output = "";  // mass_matrix, …
  int state = 0;            // which of the test's states, counted from 0
  int row = 0, column = 0;  // counted from 0; column −1: the sum over the row, each element times self_test_weight(column)
  double expected = 0, obtained = 0;
  double error = 0;      // |obtained − expected| relative to the output's largest element; DBL_MAX when not finite
  double tolerance = 0;  // largest error of right code
};

// A vector without symmetry: 1 to 2, no two entries of any 1024 neighbours equal, exact in float.
constexpr double self_test_weight(int column) { return 1 + (617 * (column % 1024) % 1024) / 1024.0; }

// What is to be compared with a table of expected numbers.
struct SelfTestSubject {
  const char* output;
  int state;
  double scale;  // errors are relative to it
  double tolerance;
};

// Each file's own: a program may hold code for several targets, and the linker must not take one's copy for another's.
namespace {

template <class Scalar>
class SelfTest {
 public:
  // `result`: rows × columns, column by column. Compares `count` columns, those listed in `chosen` or, without, the first;
  // `expected` holds them one after another.
  void elements(const SelfTestSubject& subject, const Scalar* result, int rows, const int* chosen, int count,
                const Scalar* expected) noexcept {
    for (int c = 0; c < count; ++c) {
      const int column = chosen ? chosen[c] : c;
      for (int row = 0; row < rows; ++row) compare(subject, row, column, *expected++, at(result, rows, row, column));
    }
  }

  // The same of a symmetric matrix, of whose columns `expected` holds what stands on the diagonal and below.
  void symmetric_elements(const SelfTestSubject& subject, const Scalar* result, int rows, const int* chosen, int count,
                          const Scalar* expected) noexcept {
    for (int c = 0; c < count; ++c) {
      const int column = chosen ? chosen[c] : c;
      for (int row = column; row < rows; ++row, ++expected) {
        compare(subject, row, column, *expected, at(result, rows, row, column));
        if (row > column) compare(subject, column, row, *expected, at(result, rows, column, row));
      }
    }
  }

  // Each row times the vector of weights: every element counts. `expected`: one number per row.
  void products(const SelfTestSubject& subject, const Scalar* result, int rows, int columns, const Scalar* expected) noexcept {
    for (int row = 0; row < rows; ++row) {
      double sum = 0;
      for (int column = 0; column < columns; ++column) sum += self_test_weight(column) * at(result, rows, row, column);
      compare(subject, row, -1, expected[row], sum);
    }
  }

  // Whether everything agreed. `report` may be null.
  bool finish(SelfTestReport* report) const noexcept {
    if (report) *report = worst_;
    return passed_;
  }

 private:
  static double at(const Scalar* result, int rows, int row, int column) noexcept {
    return result[static_cast<std::ptrdiff_t>(rows) * column + row];
  }
  static bool finite(double x) noexcept {
    std::uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    return (bits >> 52 & 0x7ff) != 0x7ff;
  }

  void compare(const SelfTestSubject& subject, int row, int column, double expected, double obtained) noexcept {
    const double difference = obtained - expected, error = (difference < 0 ? -difference : difference) / subject.scale;
    const bool known = finite(obtained) && finite(error);
    const double excess = known ? error / subject.tolerance : DBL_MAX;
    // An element says more than a row: once one is wrong, rows do not take its place.
    if (!passed_ && column < 0 && worst_.column >= 0) return;
    if (worst_.tolerance > 0 && excess <= excess_) return;
    worst_ = {subject.output, subject.state, row, column, expected, obtained, known ? error : DBL_MAX, subject.tolerance};
    excess_ = excess;
    passed_ = excess <= 1;
  }

  SelfTestReport worst_;
  double excess_ = 0;
  bool passed_ = true;
};

}  // namespace

// One line about the report: "mass_matrix(3, 4) at state 1 is 0.25, expected 0.5: error 0.1, allowed 1e-13". Writes at most
// `size` characters, the closing zero included.
static inline void describe(const SelfTestReport& report, char* text, std::size_t size) noexcept {
  char column[48] = "weighted sum";
  if (report.column >= 0) std::snprintf(column, sizeof column, "%d", report.column);
  std::snprintf(text, size, "%s(%d, %s) at state %d is %.17g, expected %.17g: error %.3g of the largest element, allowed %.3g",
                report.output, report.row, column, report.state, report.obtained, report.expected, report.error,
                report.tolerance);
}

}  // namespace dalembert
