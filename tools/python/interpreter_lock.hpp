// SPDX-License-Identifier: MIT
#pragma once

#include <cxxabi.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

namespace seqloop::python {

/// Takes the interpreter's lock. Once the interpreter ends, nobody gets it any more: before Python
/// 3.14 the thread that asks, a daemon, is ended by unwinding, which C++ that must not be unwound
/// takes for a reason to abort. As from 3.14 on, it waits for the end of the process instead.
template <class Take>
void take_lock(Take take) {
  try {
    take();
  } catch (const abi::__forced_unwind&) {
    while (true) pause();
  }
}

/// Lets other threads of Python run, for as long as it lives.
class Unlocked {
 public:
  Unlocked() = default;
  ~Unlocked() {
    take_lock([this] { PyEval_RestoreThread(thread_); });
  }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  PyThreadState* thread_ = PyEval_SaveThread();
};

/// Takes the lock back, for as long as it lives, while an `Unlocked` does.
class Locked {
 public:
  Locked() {
    take_lock([this] { before_ = PyGILState_Ensure(); });
  }
  ~Locked() { PyGILState_Release(before_); }
  Locked(const Locked&) = delete;
  Locked& operator=(const Locked&) = delete;

 private:
  PyGILState_STATE before_;
};

}  // namespace seqloop::python
