#include "motions.hpp"

#include <Eigen/Core>
#include <dalembert/integrators/motion.hpp>
#include <vector>

#include "owned.hpp"

namespace dalembert::python {

namespace {

// Two C-contiguous float64 arrays of n rows each.
bool two_arrays(PyObject* args, PyArrayObject*& a, PyArrayObject*& b) {
  if (!PyArg_ParseTuple(args, "O!O!", &PyArray_Type, &a, &PyArray_Type, &b)) return false;
  for (PyArrayObject* array : {a, b})
    if (PyArray_NDIM(array) != 2 || PyArray_TYPE(array) != NPY_FLOAT64 || !PyArray_ISCARRAY_RO(array) ||
        PyArray_DIM(array, 0) != PyArray_DIM(a, 0)) {
      PyErr_SetString(PyExc_ValueError, "two arrays of float64 with as many rows were expected");
      return false;
    }
  return true;
}

using Vector = Eigen::Map<Eigen::VectorXd>;
Vector row_of(PyArrayObject* array, npy_intp row) {
  return {static_cast<double*>(PyArray_DATA(array)) + row * PyArray_DIM(array, 1), PyArray_DIM(array, 1)};
}

}  // namespace

bool quaternion_joints(PyArrayObject* array, std::vector<QuaternionJoint>& joints) {
  if (PyArray_NDIM(array) != 2 || PyArray_DIM(array, 1) != 3 || PyArray_TYPE(array) != NPY_INT64 ||
      !PyArray_ISCARRAY_RO(array)) {
    PyErr_SetString(PyExc_ValueError, "an array of int64 with three columns was expected");
    return false;
  }
  const auto* numbers = static_cast<const npy_int64*>(PyArray_DATA(array));
  for (npy_intp i = 0; i < PyArray_DIM(array, 0); ++i, numbers += 3)
    joints.push_back({static_cast<int>(numbers[0]), static_cast<int>(numbers[1]), numbers[2] != 0});
  return true;
}

PyObject* integrate(PyObject*, PyObject* args) {
  PyArrayObject *q, *step, *quaternions;
  if (!PyArg_ParseTuple(args, "O!O!O!", &PyArray_Type, &q, &PyArray_Type, &step, &PyArray_Type, &quaternions)) return nullptr;
  const Owned both(Py_BuildValue("(OO)", q, step));
  std::vector<QuaternionJoint> joints;
  if (!both || !two_arrays(both.get(), q, step) || !quaternion_joints(quaternions, joints)) return nullptr;
  Owned next(PyArray_SimpleNew(2, PyArray_DIMS(q), NPY_FLOAT64));
  if (!next) return nullptr;
  for (npy_intp s = 0; s < PyArray_DIM(q, 0); ++s) {
    Vector to = row_of(next.array(), s);
    integrators::move(row_of(q, s), row_of(step, s), to, joints);
  }
  return next.release();
}

PyObject* difference(PyObject*, PyObject* args) {
  PyArrayObject *from, *to, *quaternions;
  int floating;
  if (!PyArg_ParseTuple(args, "O!O!pO!", &PyArray_Type, &from, &PyArray_Type, &to, &floating, &PyArray_Type, &quaternions))
    return nullptr;
  const Owned both(Py_BuildValue("(OO)", from, to));
  std::vector<QuaternionJoint> joints;
  if (!both || !two_arrays(both.get(), from, to) || !quaternion_joints(quaternions, joints)) return nullptr;
  npy_intp sizes[] = {PyArray_DIM(from, 0), PyArray_DIM(from, 1) - (floating ? 1 : 0) - static_cast<npy_intp>(joints.size())};
  Owned step(PyArray_SimpleNew(2, sizes, NPY_FLOAT64));
  if (!step) return nullptr;
  for (npy_intp s = 0; s < sizes[0]; ++s) {
    Vector row = row_of(step.array(), s);
    integrators::difference(row_of(from, s), row_of(to, s), row, joints);
  }
  return step.release();
}

}  // namespace dalembert::python
