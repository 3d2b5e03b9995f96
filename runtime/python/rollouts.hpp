// Motions of many steps in one call: the generated rollouts of batches, and where a function has no batch, its single states.
#pragma once

#include "numpy.hpp"

namespace dalembert::python {

// A method of function_type, which Robot's rollouts call: (name, q, v, what acts or None, steps or -1, time_step, method,
// whether paths are wanted, out or None, return_status, {run-time input: value}, how contacts come on and go: (which act in
// each step or None, where the run-time inputs have it, the function that tells what an impact does, which of its results) or
// None, quaternion joints, type of the results).
PyObject* roll_out(PyObject* self, PyObject* args);

}  // namespace dalembert::python
