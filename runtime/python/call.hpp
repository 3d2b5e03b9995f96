// Calls of a function.
//
// One state costs little beside the computation: positional arguments that are arrays of the right kind go to the code as they
// are, under the GIL, into a workspace of the function's own. Everything else (other dtypes, batches, keywords) takes the long
// way, which converts, checks and says by name what is wrong. Of batches the GIL is released, and the states are shared among
// threads. Whatever a function owns is changed only by who holds the GIL.
#pragma once

#include <cstddef>

#include "numpy.hpp"

namespace dalembert::python {

// The vectorcall of function_type.
PyObject* call(PyObject* self, PyObject* const* args, std::size_t flagged, PyObject* keywords);

}  // namespace dalembert::python
