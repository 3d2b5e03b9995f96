#include "function.hpp"

#include <dlfcn.h>
#include <structmember.h>

#include <cstddef>

#include "arguments.hpp"
#include "call.hpp"
#include "rollouts.hpp"

namespace dalembert::python {

PyObject *singular_error = nullptr, *singular_warning = nullptr, *stopped_warning = nullptr;
PyObject *name_out = nullptr, *name_status = nullptr, *name_constraints = nullptr, *name_q = nullptr, *name_v = nullptr,
         *name_active = nullptr;
PyTypeObject* constraint_status_type = nullptr;
PyTypeObject function_type = [] {
  PyTypeObject type{};
  type.ob_base = {PyObject_HEAD_INIT(nullptr) 0};
  return type;
}();

namespace {

void deallocate(PyObject* self) {
  Contents* const f = reinterpret_cast<Function*>(self)->contents;
  if (f) {
    for (Code* code : {&f->single, &f->batch}) {
      for (void* workspace : code->workspaces) code->entry->destroy(workspace);
      Py_XDECREF(code->library);
    }
    for (RunTimeInput& input : f->run_time_inputs) Py_DECREF(input.name);
    for (Quaternion& quaternion : f->quaternions) Py_DECREF(quaternion.whose);
    for (PyObject* object :
         {f->find_batch, f->name, f->more, f->result_type, f->run_time, f->coordinates, f->doc, f->signature})
      Py_XDECREF(object);
    delete f;
  }
  Py_TYPE(self)->tp_free(self);
}

bool read_shapes(PyObject* list, Contents& f) {
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(list); ++i) {
    Shape shape;
    PyObject* const sizes = PyTuple_GET_ITEM(list, i);
    shape.dimensions = static_cast<int>(PyTuple_Size(sizes));
    if (shape.dimensions < 0 || shape.dimensions > 2) return false;
    for (int k = 0; k < shape.dimensions; ++k) shape.size[k] = PyLong_AsSsize_t(PyTuple_GET_ITEM(sizes, k));
    f.shapes.push_back(shape);
  }
  return !PyErr_Occurred();
}

PyObject* new_function(PyTypeObject* type, PyObject* args, PyObject*) {
  PyObject *library, *name, *more, *shapes, *result_type, *run_time, *run_time_inputs, *coordinates, *quaternions, *doc,
      *signature, *find_batch;
  int entry, needs_v, acceleration;
  Py_ssize_t nq, nv;
  if (!PyArg_ParseTuple(args, "OiUOpnnO!OOO!O!O!UOOi", &library, &entry, &name, &more, &needs_v, &nq, &nv, &PyTuple_Type,
                        &shapes, &result_type, &run_time, &PyTuple_Type, &run_time_inputs, &PyTuple_Type, &coordinates,
                        &PyTuple_Type, &quaternions, &doc, &signature, &find_batch, &acceleration))
    return nullptr;
  const FunctionTable* const functions = table_of(library);
  if (!functions) return nullptr;
  const FunctionTable& table = *functions;
  if (entry < 0 || entry >= table.functions || table.entries[entry].results != PyTuple_GET_SIZE(shapes)) {
    PyErr_SetString(PyExc_ValueError, "no such function in this library");
    return nullptr;
  }
  Owned self(type->tp_alloc(type, 0));
  if (!self) return nullptr;
  auto* const function = reinterpret_cast<Function*>(self.get());
  function->call = call;
  auto* const f = function->contents = new Contents;
  const auto keep = [](PyObject* object) { return object == Py_None ? nullptr : Py_NewRef(object); };
  f->single.entry = &table.entries[entry];
  f->nq = nq;
  f->nv = nv;
  f->needs_v = needs_v;
  f->acceleration = acceleration;
  f->type = table.scalar_bytes == 4 ? NPY_FLOAT32 : NPY_FLOAT64;
  f->scalar = static_cast<std::size_t>(table.scalar_bytes);
  f->single.library = keep(library);
  f->find_batch = keep(find_batch);
  f->name = keep(name);
  f->more = keep(more);
  if (f->more) PyUnicode_InternInPlace(&f->more);
  f->result_type = keep(result_type);
  f->run_time = keep(run_time);
  f->coordinates = keep(coordinates);
  f->doc = keep(doc);
  f->signature = keep(signature);
  f->zeros.assign(static_cast<std::size_t>(nv), 0.0);
  if (!read_shapes(shapes, *f)) return nullptr;
  if (f->result_type &&
      (!PyType_Check(f->result_type) || !PyType_IsSubtype(reinterpret_cast<PyTypeObject*>(f->result_type), &PyTuple_Type))) {
    PyErr_SetString(PyExc_TypeError, "the results' type is no tuple");
    return nullptr;
  }
  if (f->run_time &&
      (Py_TYPE(f->run_time) != &PyArray_Type || PyArray_TYPE(reinterpret_cast<PyArrayObject*>(f->run_time)) != f->type ||
       !PyArray_ISCARRAY(reinterpret_cast<PyArrayObject*>(f->run_time)))) {
    PyErr_SetString(PyExc_TypeError, "the run-time inputs are no array of the library's scalar");
    return nullptr;
  }
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(run_time_inputs); ++i) {
    PyObject* input;
    int at, size;
    if (!PyArg_ParseTuple(PyTuple_GET_ITEM(run_time_inputs, i), "Uii", &input, &at, &size)) return nullptr;
    f->run_time_inputs.push_back({Py_NewRef(input), at, size, held_by(input)});
  }
  for (Py_ssize_t i = 0; i < PyTuple_GET_SIZE(quaternions); ++i) {
    PyObject* whose;
    Py_ssize_t first;
    if (!PyArg_ParseTuple(PyTuple_GET_ITEM(quaternions, i), "nU", &first, &whose)) return nullptr;
    f->quaternions.push_back({first, Py_NewRef(whose)});
  }
  return self.release();
}

PyObject* object_or_none(PyObject* object) { return Py_NewRef(object ? object : Py_None); }
Contents& of(PyObject* self) { return *reinterpret_cast<Function*>(self)->contents; }

PyObject* represent(PyObject* self) {
  return of(self).signature ? PyUnicode_FromFormat("<%U%S>", of(self).name, of(self).signature)
                            : PyUnicode_FromFormat("<%U>", of(self).name);
}

PyMethodDef function_methods[] = {{"roll_out", roll_out, METH_VARARGS, "Motions of many steps; see Robot."}, {}};

PyGetSetDef function_attributes[] = {
    {"__name__", [](PyObject* self, void*) { return object_or_none(of(self).name); }, nullptr, nullptr, nullptr},
    {"__doc__", [](PyObject* self, void*) { return object_or_none(of(self).doc); }, nullptr, nullptr, nullptr},
    {"__signature__", [](PyObject* self, void*) { return object_or_none(of(self).signature); }, nullptr, nullptr, nullptr},
    {"has_status", [](PyObject* self, void*) { return PyBool_FromLong(of(self).single.entry->has_status); }, nullptr,
     "Whether the function needs M to be positive definite, and says where it is not.", nullptr},
    {"has_constraint_status", [](PyObject* self, void*) { return PyBool_FromLong(of(self).single.entry->has_constraints); },
     nullptr, "Whether the function solves for contacts or loops, and says what came of it.", nullptr},
    {}};

}  // namespace

const FunctionTable* table_of(PyObject* library) {
  void* const handle = PyCapsule_GetPointer(library, library_capsule);
  if (!handle) return nullptr;
  const auto table = reinterpret_cast<const FunctionTable* (*)()>(dlsym(handle, "dalembert_function_table"));
  if (!table || table()->version != function_table_version) {
    PyErr_SetString(PyExc_OSError, "the compiled code is not of this version of dalembert");
    return nullptr;
  }
  return table();
}

bool prepare_function_type() {
  function_type.tp_name = "dalembert.Function";
  function_type.tp_doc = "A function of a robot: q, q and v, or q, v and a or tau go in, arrays of one state or of n come out.";
  function_type.tp_basicsize = sizeof(Function);
  function_type.tp_flags = Py_TPFLAGS_DEFAULT | Py_TPFLAGS_HAVE_VECTORCALL;
  function_type.tp_vectorcall_offset = offsetof(Function, call);
  function_type.tp_call = PyVectorcall_Call;
  function_type.tp_new = new_function;
  function_type.tp_dealloc = deallocate;
  function_type.tp_repr = represent;
  function_type.tp_getset = function_attributes;
  function_type.tp_methods = function_methods;
  return PyType_Ready(&function_type) == 0;
}

}  // namespace dalembert::python
