#include "seqloop/interruption.hpp"

#include <signal.h>

#include <stdexcept>

namespace seqloop::program {
namespace {

volatile sig_atomic_t asked = 0;

void ask(int /*signal*/) { asked = 1; }

}  // namespace

void take_interruptions() noexcept {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler == SIG_IGN) continue;  // nohup and the shell's & want it so
    struct sigaction action {};
    action.sa_handler = ask;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(signal, &action, nullptr);
  }
}

bool interrupted() noexcept { return asked != 0; }

void stop_if_interrupted() {
  if (interrupted()) throw std::runtime_error("interrupted: nothing has been written");
}

}  // namespace seqloop::program
