// Motions of many steps in one call: the generated rollouts of batches, and where a function has no batch, its single states.
#pragma once

#include "numpy.hpp"

namespace dalembert::python {

// A method of function_type, which Robot's rollouts call: (name, q, v, what acts or None, steps or -1, time_step, method,
// whether paths are wanted, out or None, return_status, {run-time input: value}, quaternion joints, type of the results).
PyObject* roll_out(PyObject* self, PyObject* args);

}  // namespace dalembert::python
