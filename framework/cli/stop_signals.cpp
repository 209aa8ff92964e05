#include "framework/cli/stop_signals.hpp"

#include <csignal>

namespace tomlin {
namespace {

// A signal handler reaches nothing but globals.
std::atomic<bool> g_stop{false};
std::atomic<int> g_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

void act_on(int signal, void (*handler)(int)) {
  struct sigaction action = {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

void act_on_both(void (*handler)(int)) {
  act_on(SIGINT, handler);
  act_on(SIGTERM, handler);
}

extern "C" void stop_the_run(int signal) {
  g_signal = signal;
  g_stop = true;
  act_on_both(SIG_DFL);
}

}  // namespace

StopSignals::StopSignals() {
  g_stop = false;
  g_signal = 0;
  act_on_both(&stop_the_run);
}

StopSignals::~StopSignals() { act_on_both(SIG_DFL); }

const std::atomic<bool>& StopSignals::stop() const { return g_stop; }

void StopSignals::request_stop() { g_stop = true; }

int StopSignals::caught() const { return g_signal; }

}  // namespace tomlin
