// Bytes of machine code and of constant tables in a static library, as binutils' `size` counts them.
#pragma once

#include <string>

namespace dalembert::benchmarks {

struct CodeSize {
  long text = 0;    // sections .text*
  long tables = 0;  // sections .rodata*
};

// Of all members but the C API's thin shell and the self-test, which is linked only where it is called. Throws
// std::runtime_error when `size` cannot be run.
CodeSize code_size(const std::string& archive);

}  // namespace dalembert::benchmarks
