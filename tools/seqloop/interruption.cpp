#include "seqloop/interruption.hpp"

#include <csignal>
#include <stdexcept>

namespace seqloop::program {
namespace {

volatile std::sig_atomic_t asked = 0;

void ask(int /*signal*/) { asked = 1; }

}  // namespace

void take_interruptions() noexcept {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, ask);
  std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() noexcept { return asked != 0; }

void stop_if_interrupted() {
  if (interrupted()) throw std::runtime_error("interrupted: nothing has been written");
}

}  // namespace seqloop::program
