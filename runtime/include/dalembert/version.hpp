// The runtime's version. Generated code asserts at compile time that it matches the runtime it is compiled against.
#pragma once

namespace dalembert {

// Raised whenever generated code of an earlier generator no longer compiles or behaves the same against this runtime.
inline constexpr int runtime_version = 1;

}  // namespace dalembert
