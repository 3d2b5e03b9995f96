// What becomes of the scene's results in states, and with loads, that tests seldom see.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"
#include "commands/report/variants.hpp"

namespace dalembert::reporting {

// Verdicts of section `stability`, metric `verdict`. Of cases that are measured against exact results: good up to 32 ulp of the
// largest exact element (of what solves with M, 5 cond(M) where that is more), weak up to 128 times as much or where M is
// reported singular, else bad. Of the others: good when what the case promises (docs/report.md) is what happens, else bad. Bad
// is also whatever is not finite where the exact result is.
inline constexpr const char* good = "good";
inline constexpr const char* weak = "weak";
inline constexpr const char* bad = "bad";

// Rows of section `stability`: per case, output and scalar what was measured, its verdict and, of what is bad, `violated`: what
// was, and by how much, in words whose numbers are rows too. Adds to section `rounding` the
// time of all outputs together.
// By the engines that were ordered.
std::vector<Order> stability_orders(const Subject& subject);
void add_stability(const Subject& subject, std::span<const std::unique_ptr<GeneratedEngine>> engines, Rows& rows);

}  // namespace dalembert::reporting
