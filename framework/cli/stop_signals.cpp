#include "framework/cli/stop_signals.hpp"

#include <csignal>

namespace tomlin {
namespace {

// A signal handler reaches nothing but globals.
std::atomic<bool> g_stop{false};
std::atomic<int> g_signal{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

constexpr int kSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGUSR1, SIGXCPU};

void act_on_all(void (*handler)(int)) {
  for (const int signal : kSignals) {
    struct sigaction before = {};
    // To ignore a signal is the decision of whoever has started the program.
    if (sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) continue;
    struct sigaction action = {};
    action.sa_handler = handler;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
  }
}

extern "C" void stop_the_run(int signal) {
  g_signal = signal;
  g_stop = true;
  act_on_all(SIG_DFL);
  // The kernel repeats this one every second of processor time; the run is ending already.
  if (signal == SIGXCPU) std::signal(SIGXCPU, SIG_IGN);
}

}  // namespace

StopSignals::StopSignals() {
  g_stop = false;
  g_signal = 0;
  // A full disk or a reader that went away is an error that is reported, not the end.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  act_on_all(&stop_the_run);
}

StopSignals::~StopSignals() { act_on_all(SIG_DFL); }

const std::atomic<bool>& StopSignals::stop() const { return g_stop; }

void StopSignals::request_stop() { g_stop = true; }

int StopSignals::caught() const { return g_signal; }

}  // namespace tomlin
