// Calls of a function.
//
// One state costs little beside the computation: positional arguments that are arrays of the right kind go to the code as they
// are, under the GIL, into a workspace of the function's own. Everything else (other dtypes, batches, keywords) takes the long
// way, which converts, checks and says by name what is wrong. Of batches the GIL is released, and the states are shared among
// threads. Whatever a function owns is changed only by who holds the GIL.
#pragma once

#include <cstddef>
#include <vector>

#include "function.hpp"
#include "numpy.hpp"

namespace dalembert::python {

// The function's batch, found when it is asked for first; without one batch.entry stays null. False with an error set.
bool find_batch(Contents& f);

// Results as the caller gets them: one, or a named tuple; a number rather than an array without axes where `as_scalar`.
PyObject* packed(const Contents& f, std::vector<Owned>& results, bool as_scalar);

// The vectorcall of function_type.
PyObject* call(PyObject* self, PyObject* const* args, std::size_t flagged, PyObject* keywords);

}  // namespace dalembert::python
