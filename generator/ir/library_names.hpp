// Names that the C and C++ libraries take before a robot can: where the front end would emit one bare, it refuses it.
#pragma once

#include <string_view>

namespace dalembert::ir {

// Whether a header that generated code includes, or stands beside it, defines the name as a macro for a value, or all names
// that begin so are left to such macros (EIGEN_, SYS_): no identifier can be called so.
bool is_library_macro(std::string_view text);

// Whether the name is left to macros of the runtime and of generated code: DALEMBERT_..., and guards of headers for C, of
// any robot. No identifier can be called so.
bool is_macro_of_the_code(std::string_view text);

// Whether such a header declares the name at global scope, a function, a type or a constant: no namespace can be called so,
// while an enumerator can.
bool is_library_name(std::string_view text);

}  // namespace dalembert::ir
