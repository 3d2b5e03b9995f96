// How many cycles operations wait for those before, on the processors of the time: what orders of statements and sums go by.
#pragma once

namespace dalembert::ir {

inline constexpr int latency = 4;  // of a sum or a product
inline constexpr int divide_latency = 13;

}  // namespace dalembert::ir
