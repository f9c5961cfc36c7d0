#include "gil.h"

#include <unistd.h>

namespace python {
namespace {

// The thread state that we have made for this thread.
class Own {
 public:
  ~Own() {
    if (!state_ || _Py_IsFinalizing()) return;
    PyEval_RestoreThread(state_);
    PyThreadState_Clear(state_);
    PyThreadState_DeleteCurrent();
  }
  PyThreadState* get() {
    // The thread of Python has one already.
    if (PyThreadState* const known = PyGILState_GetThisThreadState()) return known;
    state_ = PyThreadState_New(PyInterpreterState_Main());
    return state_;
  }

 private:
  PyThreadState* state_ = nullptr;
};
thread_local Own own;

// Only the thread that finalizes the interpreter, the main one, can still take the lock then: destructors of what Python lets go need it.
bool comes_too_late() { return _Py_IsFinalizing() && gettid() != getpid(); }

}  // namespace

Locked::Locked() {
  while (comes_too_late()) pause();
  PyThreadState* const state = own.get();
  is_nested_ = _PyThreadState_UncheckedGet() == state;
  if (!is_nested_) PyEval_RestoreThread(state);
}

Locked::~Locked() {
  if (!is_nested_) PyEval_SaveThread();
}

std::string take_error() {
  PyObject *type = nullptr, *value = nullptr, *trace = nullptr;
  PyErr_Fetch(&type, &value, &trace);
  if (!type) return "no exception is set";
  PyErr_NormalizeException(&type, &value, &trace);
  const Ref owned_type(type), owned_value(value), owned_trace(trace);
  std::string text;
  if (const Ref module(PyImport_ImportModule("traceback")); module) {
    const Ref lines(PyObject_CallMethod(module.get(), "format_exception", "OOO", type, value ? value : Py_None, trace ? trace : Py_None));
    const Ref nothing(PyUnicode_FromString(""));
    const Ref joined(lines ? PyUnicode_Join(nothing.get(), lines.get()) : nullptr);
    if (const char* utf8 = joined ? PyUnicode_AsUTF8(joined.get()) : nullptr) text = utf8;
  }
  if (text.empty()) {
    PyErr_Clear();
    text = reinterpret_cast<PyTypeObject*>(type)->tp_name;
  }
  PyErr_Clear();
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace python
