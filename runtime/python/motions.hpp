// Motions of states on their group, of n states row by row.
#pragma once

#include "numpy.hpp"

namespace dalembert::python {

PyObject* integrate(PyObject* module, PyObject* args);   // rows of q and of twists
PyObject* difference(PyObject* module, PyObject* args);  // rows of q, rows of q, whether the base floats

}  // namespace dalembert::python
