// What an entry of the cache depends on, as a key.
#pragma once

#include <string>

#include "commands/compiler.hpp"
#include "pipeline.hpp"

namespace dalembert {

// Of this program and the headers that it compiles with.
std::string generator_id();

// Of the inputs' bytes and names, the generator, compiler and flags, the processor. 32 hexadecimal digits.
std::string key_of(const Request& request, const CompilerOptions& options);

}  // namespace dalembert
