#include <chrono>
#include <csignal>
#include <cstddef>
#include <exception>
#include <new>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <unistd.h>

#include "framework/core/text/fault.hpp"
#include "framework/core/text/fault_code.hpp"
#include "framework/model/plugin_code.hpp"
#include "framework/output/output_file.hpp"
#include "framework/output/record.hpp"
#include "framework/python/handles.hpp"

namespace tomlin::python {
namespace {

// A signal handler reaches nothing but globals.
std::atomic<std::atomic<bool>*> g_stop{nullptr};
static_assert(std::atomic<std::atomic<bool>*>::is_always_lock_free);

extern "C" void ask_to_stop(int) {
  if (std::atomic<bool>* const stop = g_stop) *stop = true;
}

/// Whether Ctrl-C does what Python does by itself.
bool has_default_handler() {
  const py::module_ signal = py::module_::import("signal");
  return signal.attr("getsignal")(SIGINT).is(signal.attr("default_int_handler"));
}

/// Options of the program as the arguments of functions that they are here.
Fault with_arguments(Fault fault) {
  static constexpr std::pair<std::string_view, std::string_view> kArguments[] = {
      {"--force", "force=True"}, {"--resume", "resume=True"}};
  for (std::string* text : {&fault.location.file, &fault.why, &fault.admissible}) {
    for (const auto& [option, argument] : kArguments) {
      const std::size_t at = text->find(option);
      if (at != std::string::npos) text->replace(at, option.size(), argument);
    }
  }
  if (fault.location.file == "-o") fault.location.file = "folder=";
  return fault;
}

py::dict dict_of(const Fault& from) {
  const Fault fault = with_arguments(from);
  py::dict all;
  all["code"] = std::string(id_of(fault.code));
  all["file"] = text_of(fault.location.file);
  all["line"] = fault.location.line;
  all["column"] = fault.location.column;
  all["key"] = text_of(fault.key);
  all["value"] = text_of(fault.value);
  all["message"] = text_of(fault.why);
  all["admissible"] = text_of(fault.admissible);
  all["nearest"] = text_of(fault.nearest);
  all["text"] = text_of(to_string(fault));
  return all;
}

/// Throws a class of tomlin/_errors.py.
template <class Argument>
void set_error(const char* name, const Argument& argument) {
  const py::object type = py::module_::import("tomlin._errors").attr(name);
  PyErr_SetObject(type.ptr(), type(argument).ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const InputError& error) {
    py::list faults;
    for (const Fault& fault : error.faults()) faults.append(dict_of(fault));
    set_error("SceneError", faults);
  } catch (const OutputError& error) {
    set_error("OutputError", text_of(error.what()));
  } catch (const DamagedFile& error) {
    set_error("OutputError", text_of(error.what()));
  } catch (const PluginError& error) {
    set_error("RunError", text_of(error.what()));
  } catch (const py::builtin_exception&) {
    throw;
  } catch (const py::error_already_set&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    set_error("RunError", text_of(error.what()));  // of the code of a plugin
  }
}

}  // namespace

py::str text_of(const std::string& bytes) {
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(
      bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "backslashreplace"));
}

bool is_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("get_ident")().equal(threading.attr("main_thread")().attr("ident"));
}

void wait_for_ever_if_interpreter_ends() {
#if PY_VERSION_HEX >= 0x030d0000
  const bool ends = Py_IsFinalizing() != 0;
#else
  const bool ends = _Py_IsFinalizing() != 0;
#endif
  if (!ends || ::gettid() == ::getpid()) return;
  for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
}

InterruptGuard::InterruptGuard() {
  if (!is_main_thread() || !has_default_handler()) return;
  // To ignore the signal is the decision of whoever has started Python.
  if (sigaction(SIGINT, nullptr, &before_) != 0 || before_.sa_handler == SIG_IGN) return;
  outer_ = g_stop.exchange(&stop_);
  struct sigaction action = {};
  action.sa_handler = ask_to_stop;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  is_set_ = true;
}

InterruptGuard::~InterruptGuard() {
  if (!is_set_) return;
  sigaction(SIGINT, &before_, nullptr);
  g_stop = outer_;
}

py::array numbers_of(py::handle owner, const double* numbers, std::vector<py::ssize_t> shape) {
  static const double nothing = 0.0;
  py::array array(py::dtype::of<double>(), std::move(shape), {},
                  numbers == nullptr ? &nothing : numbers, owner);
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

}  // namespace tomlin::python

PYBIND11_MODULE(_core, module) {
  using namespace tomlin::python;
  module.doc() = "The C++ library of tomlin; the package tomlin is what to use.";
  py::register_local_exception_translator(translate);
  module.attr("version") = TOMLIN_VERSION;
  define_scenes(module);
  define_runs(module);
  define_simulations(module);
  define_sweeps(module);
}
