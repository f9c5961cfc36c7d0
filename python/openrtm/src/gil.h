// Entering and leaving Python from threads of the runtime.
//
// States of a thread: without the interpreter's lock (all threads of the runtime, between callbacks), with it (inside a callback, in
// Python code). Rights: Python objects are touched with the lock only; a caller of the runtime gives the lock back first (Released), and
// no thread takes it while it holds a lock of the runtime. A thread of the runtime gets one thread state, kept until it ends, because
// making one costs 7 us. Failure cases: a thread that keeps the lock for ever stops all others that want it; the end of the process does
// not want it (manager/end.cpp ends the process within its time limit). A thread that wants the lock of an interpreter that is being
// finalized would be ended by Python inside our frames, which aborts the process. So close_doors() comes before: from then on entering
// blocks for ever, except for the main thread, which finalizes the interpreter; the process ends in that moment.
#pragma once

#include <Python.h>

#include <stdexcept>
#include <string>
#include <utility>

namespace python {

// Before the interpreter is finalized, on the main thread with the lock. Waits until nobody is on the way in, and asks callbacks that still
// run Python code to end with SystemExit; those that wait in a call of the system stay where they are. Takes at most two seconds.
void close_doors();

// Takes the lock with this thread state, unless the doors are closed: then it never returns.
void enter(PyThreadState* state);

// Holds the interpreter's lock; nested ones are free.
class Locked {
 public:
  Locked();
  ~Locked();
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;

 private:
  bool is_nested_;  // the thread has the lock already
  bool is_outermost_ = false;
};

// Gives the lock back while it lives. Needs the lock.
class Released {
 public:
  Released() : state_(PyEval_SaveThread()) {}
  ~Released() { enter(state_); }
  Released(const Released&) = delete;
  Released& operator=(const Released&) = delete;

 private:
  PyThreadState* const state_;
};

// Runs `call` without the lock.
template <class Call>
auto unlocked(Call call) {
  const Released released;
  return call();
}

// An owned reference. Made, copied and destroyed with the lock.
class Ref {
 public:
  Ref() = default;
  // Takes it over.
  explicit Ref(PyObject* object) : object_(object) {}
  static Ref borrowed(PyObject* object) {
    Py_XINCREF(object);
    return Ref(object);
  }
  Ref(const Ref& other) : object_(other.object_) { Py_XINCREF(object_); }
  Ref(Ref&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Ref& operator=(Ref other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Ref() { Py_XDECREF(object_); }
  PyObject* get() const { return object_; }
  PyObject* release() { return std::exchange(object_, nullptr); }
  explicit operator bool() const { return object_ != nullptr; }

 private:
  PyObject* object_ = nullptr;
};

// An owned reference that threads without the lock destroy.
class Kept {
 public:
  explicit Kept(PyObject* object) : object_(object) { Py_XINCREF(object); }
  ~Kept() {
    if (!object_) return;
    const Locked locked;
    Py_DECREF(object_);
  }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
  PyObject* get() const { return object_; }

 private:
  PyObject* const object_;
};

// The Python exception that is set, as text: what was raised, then the traceback; it is cleared. Needs the lock.
std::string take_error();

// A Python exception on its way through C++: its text. The runtime logs it and goes to the error state.
class Raised : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace python
