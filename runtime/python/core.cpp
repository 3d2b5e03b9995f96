// dalembert._core: the functions of a robot's compiled code as Python objects that take and give numpy arrays. function.cpp has
// the type, call.cpp its calls, arguments.cpp what may be given; here is the module.
#define DALEMBERT_IMPORTS_NUMPY
#include <dlfcn.h>

#include "arguments.hpp"
#include "function.hpp"
#include "motions.hpp"
#include "workers.hpp"

namespace dalembert::python {
namespace {

PyObject* open_library(PyObject*, PyObject* args) {
  PyObject* path;
  if (!PyArg_ParseTuple(args, "O&", PyUnicode_FSConverter, &path)) return nullptr;
  const Owned bytes(path);
  void* const handle = dlopen(PyBytes_AS_STRING(path), RTLD_NOW | RTLD_LOCAL);
  if (!handle) return PyErr_Format(PyExc_OSError, "%s", dlerror());
  Owned capsule(
      PyCapsule_New(handle, library_capsule, [](PyObject* self) { dlclose(PyCapsule_GetPointer(self, library_capsule)); }));
  if (!capsule) return nullptr;
  if (!table_of(capsule.get())) return nullptr;
  return capsule.release();
}

PyObject* threads(PyObject*, PyObject* args) {
  constexpr int most = 1024;
  int count = 0;
  if (!PyArg_ParseTuple(args, "|i", &count)) return nullptr;
  if (PyTuple_GET_SIZE(args) > 0 && (count < 1 || count > most))
    return PyErr_Format(PyExc_ValueError, "threads: %d threads are too %s, expected 1 to %d", count, count < 1 ? "few" : "many",
                        most);
  if (count > 0) Workers::instance().set_count(count);
  return PyLong_FromLong(Workers::instance().count());
}

PyObject* has_constraint_status(PyObject*, PyObject* args) {
  PyObject* library;
  int entry;
  if (!PyArg_ParseTuple(args, "Oi", &library, &entry)) return nullptr;
  const FunctionTable* const table = table_of(library);
  if (!table) return nullptr;
  return PyBool_FromLong(entry >= 0 && entry < table->functions && table->entries[entry].has_constraints);
}

// Of C-contiguous rows of q, which move; of each its status as numbers, three by three.
PyObject* close_loops(PyObject*, PyObject* args) {
  PyObject* library;
  PyArrayObject* q;
  if (!PyArg_ParseTuple(args, "OO!", &library, &PyArray_Type, &q)) return nullptr;
  const FunctionTable* const table = table_of(library);
  if (!table) return nullptr;
  if (!table->close_loops || PyArray_NDIM(q) != 2 || PyArray_ITEMSIZE(q) != table->scalar_bytes || !PyArray_ISCARRAY(q))
    return PyErr_Format(PyExc_ValueError, "rows of q of a robot with embedded loops were expected");
  npy_intp sizes[] = {PyArray_DIM(q, 0), 3};
  Owned status(PyArray_SimpleNew(2, sizes, NPY_DOUBLE));
  if (!status) return nullptr;
  Py_BEGIN_ALLOW_THREADS;
  table->close_loops(PyArray_DATA(q), sizes[0], static_cast<double*>(PyArray_DATA(status.array())));
  Py_END_ALLOW_THREADS;
  return status.release();
}

PyStructSequence_Field constraint_status_fields[] = {
    {"residual",
     "the largest error that is left of a row that acts: m/s^2 or rad/s^2, of an impact m/s or rad/s; of inverse "
     "dynamics the largest effort that is left where there is no motor: N or N m"},
    {"least_pivot",
     "at most 1; near 1e-8 (float: 1e-4) where rows say what others say; -1 where a weight is negative or not finite"},
    {"rank", "how many rows that act say something new"},
    {}};
PyStructSequence_Desc constraint_status_description = {
    "dalembert.ConstraintStatus", "What solving for contacts and loops came to, of one state or, as arrays, of n.",
    constraint_status_fields, 3};

PyMethodDef module_functions[] = {
    {"open", open_library, METH_VARARGS, "A robot's compiled code, loaded."},
    {"has_constraint_status", has_constraint_status, METH_VARARGS, "Whether an entry of a library has one."},
    {"close_loops", close_loops, METH_VARARGS, "Rows of q whose embedded loops are closed, in place, and what is left."},
    {"check_run_time_input", check_run_time_input, METH_VARARGS, "Refuses a contact's or loop's numbers that cannot hold."},
    {"integrate", integrate, METH_VARARGS, "Rows of q moved by rows of twists."},
    {"difference", difference, METH_VARARGS, "The twists that lead from rows of q to others."},
    {"threads", threads, METH_VARARGS, "How many threads share a batch; an argument sets it."},
    {}};

PyModuleDef module_definition = {
    PyModuleDef_HEAD_INIT, "dalembert._core", nullptr, -1, module_functions, nullptr, nullptr, nullptr, nullptr};

}  // namespace
}  // namespace dalembert::python

PyMODINIT_FUNC PyInit__core() {
  using namespace dalembert::python;
  import_array();
  if (!prepare_function_type()) return nullptr;
  name_out = PyUnicode_InternFromString("out");
  name_status = PyUnicode_InternFromString("return_status");
  name_constraints = PyUnicode_InternFromString("return_constraint_status");
  name_q = PyUnicode_InternFromString("q");
  name_v = PyUnicode_InternFromString("v");
  name_active = PyUnicode_InternFromString("active");
  Owned module(PyModule_Create(&module_definition));
  if (!module) return nullptr;
  singular_error = PyErr_NewExceptionWithDoc(
      "dalembert.SingularError", "The mass matrix is not positive definite at a state, and a result needs its inverse.",
      PyExc_ArithmeticError, nullptr);
  singular_warning = PyErr_NewExceptionWithDoc("dalembert.SingularWarning",
                                               "The mass matrix is not positive definite at some states of a batch.",
                                               PyExc_RuntimeWarning, nullptr);
  stopped_warning = PyErr_NewExceptionWithDoc(
      "dalembert.StoppedWarning", "Motions of a rollout could not make all of their steps.", PyExc_RuntimeWarning, nullptr);
  constraint_status_type = PyStructSequence_NewType(&constraint_status_description);
  if (!singular_error || !singular_warning || !stopped_warning || !constraint_status_type ||
      PyModule_AddObjectRef(module.get(), "ConstraintStatus", reinterpret_cast<PyObject*>(constraint_status_type)) < 0 ||
      PyModule_AddObjectRef(module.get(), "SingularError", singular_error) < 0 ||
      PyModule_AddObjectRef(module.get(), "SingularWarning", singular_warning) < 0 ||
      PyModule_AddObjectRef(module.get(), "StoppedWarning", stopped_warning) < 0 ||
      PyModule_AddObjectRef(module.get(), "Function", reinterpret_cast<PyObject*>(&function_type)) < 0)
    return nullptr;
  return module.release();
}
