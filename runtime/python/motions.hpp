// Motions of states on their group, of n states row by row.
#pragma once

#include <dalembert/quaternion_joint.hpp>
#include <vector>

#include "numpy.hpp"

namespace dalembert::python {

PyObject* integrate(PyObject* module, PyObject* args);   // rows of q and of twists
PyObject* difference(PyObject* module, PyObject* args);  // rows of q, rows of q, whether the base floats

// Joints with a quaternion, from rows of a C-contiguous int64 array: where they begin in q and v, and whether they slide. False
// with an error set.
bool quaternion_joints(PyArrayObject* array, std::vector<QuaternionJoint>& joints);

}  // namespace dalembert::python
