// The runtime's version. Generated code asserts at compile time that it matches the runtime it is compiled against.
#pragma once

namespace dalembert {

// Raised whenever generated code of an earlier generator no longer compiles or behaves the same against this runtime.
inline constexpr int runtime_version = 16;

// Before C++17 `new` gives a workspace less than the alignment it has, and the code crashes.
static_assert(__cplusplus >= 201703L, "dalembert needs C++17: compile with -std=c++17 or later");

}  // namespace dalembert
