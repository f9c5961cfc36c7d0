#include "gil.h"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

#include "base/guarded.h"

namespace python {
namespace {

using namespace std::chrono_literals;

std::atomic<bool> doors_are_closed{false};
std::atomic<int> entering{0};  // threads between the look at the doors and the lock; pairs by sequential consistency with the doors

bool is_main_thread() { return gettid() == getpid(); }

// A thread that has been here: its thread state, and whether it runs Python code for the runtime.
class Own {
 public:
  Own() { all().lock()->push_back(this); }
  ~Own() {
    std::erase(*all().lock(), this);
    if (!state_ || _Py_IsFinalizing() || doors_are_closed) return;
    enter(state_);
    PyThreadState_Clear(state_);
    PyThreadState_DeleteCurrent();
  }
  PyThreadState* get() {
    // The thread of Python has one already.
    if (PyThreadState* const known = PyGILState_GetThisThreadState()) return known;
    state_ = PyThreadState_New(PyInterpreterState_Main());
    return state_;
  }
  // Of the outermost Locked; written with the interpreter's lock.
  std::atomic<unsigned long> running_thread{0};

  static std::vector<unsigned long> threads_in_python() {
    std::vector<unsigned long> found;
    auto owns = all().lock();
    for (const Own* one : *owns)
      if (const unsigned long thread = one->running_thread; thread && thread != PyThread_get_thread_ident()) found.push_back(thread);
    return found;
  }

 private:
  using All = base::Guarded<std::vector<Own*>, base::Rank::noted>;
  // Never destroyed: threads end after main().
  static All& all() {
    static auto& list = *new All;
    return list;
  }
  PyThreadState* state_ = nullptr;
};
thread_local Own own;

// Gives the lock back meanwhile; false when it is not true in time.
template <class Condition>
bool becomes(Condition condition, std::chrono::milliseconds timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    PyThreadState* const state = PyEval_SaveThread();
    std::this_thread::sleep_for(1ms);
    PyEval_RestoreThread(state);
  }
  return true;
}

}  // namespace

void enter(PyThreadState* state) {
  ++entering;
  if (doors_are_closed && !is_main_thread()) {
    --entering;
    while (true) pause();
  }
  PyEval_RestoreThread(state);
  --entering;
}

void close_doors() {
  doors_are_closed = true;
  becomes([] { return entering == 0; }, 1000ms);
  for (const unsigned long thread : Own::threads_in_python()) PyThreadState_SetAsyncExc(thread, PyExc_SystemExit);
  becomes([] { return Own::threads_in_python().empty(); }, 1000ms);
}

Locked::Locked() {
  PyThreadState* const state = own.get();
  is_nested_ = _PyThreadState_UncheckedGet() == state;
  if (!is_nested_) enter(state);
  if (own.running_thread == 0) {
    own.running_thread = state->thread_id;
    is_outermost_ = true;
  }
}

Locked::~Locked() {
  if (is_outermost_) own.running_thread = 0;
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
  // What was raised stands first: many show one line of a message.
  const auto last = text.rfind('\n');
  return last == std::string::npos ? text : text.substr(last + 1) + "\n" + text;
}

}  // namespace python
