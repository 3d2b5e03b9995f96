#include "motions.hpp"

#include <Eigen/Core>
#include <dalembert/integrators/motion.hpp>

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

PyObject* integrate(PyObject*, PyObject* args) {
  PyArrayObject *q, *step;
  if (!two_arrays(args, q, step)) return nullptr;
  Owned next(PyArray_SimpleNew(2, PyArray_DIMS(q), NPY_FLOAT64));
  if (!next) return nullptr;
  for (npy_intp s = 0; s < PyArray_DIM(q, 0); ++s) {
    Vector to = row_of(next.array(), s);
    integrators::move(row_of(q, s), row_of(step, s), to);
  }
  return next.release();
}

PyObject* difference(PyObject*, PyObject* args) {
  PyArrayObject *from, *to;
  int floating;
  if (!PyArg_ParseTuple(args, "O!O!p", &PyArray_Type, &from, &PyArray_Type, &to, &floating)) return nullptr;
  const Owned both(Py_BuildValue("(OO)", from, to));
  if (!both || !two_arrays(both.get(), from, to)) return nullptr;
  npy_intp sizes[] = {PyArray_DIM(from, 0), PyArray_DIM(from, 1) - (floating ? 1 : 0)};
  Owned step(PyArray_SimpleNew(2, sizes, NPY_FLOAT64));
  if (!step) return nullptr;
  for (npy_intp s = 0; s < sizes[0]; ++s) {
    Vector row = row_of(step.array(), s);
    integrators::difference(row_of(from, s), row_of(to, s), row);
  }
  return step.release();
}

}  // namespace dalembert::python
