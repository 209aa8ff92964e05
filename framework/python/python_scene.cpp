#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "framework/cli/check_json.hpp"
#include "framework/cli/compare_text.hpp"
#include "framework/cli/explanation.hpp"
#include "framework/cli/plugins.hpp"
#include "framework/cli/tradeoff_text.hpp"
#include "framework/plugin/load.hpp"
#include "framework/python/handles.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/compare.hpp"
#include "framework/study/tradeoff/tradeoff.hpp"

namespace tomlin::python {
namespace {

using Settings = std::vector<std::pair<std::string, std::string>>;

/// Scenes without plugins share one registry.
SceneHandle read(std::shared_ptr<const SceneDocument> document,
                 const std::vector<std::string>& plugins,
                 const std::shared_ptr<const Registry>& standard) {
  SceneHandle handle;
  handle.registry = standard;
  handle.plugins = plugins;
  const auto requests = requested_plugins(plugins, {document.get(), 1});
  if (!requests.empty()) {
    auto with_plugins = std::make_shared<Registry>(standard_registry());
    load_plugins(requests, *with_plugins);
    handle.registry = std::move(with_plugins);
  }
  handle.scene = document->read(*handle.registry);
  handle.document = std::move(document);
  return handle;
}

SceneHandle with_settings(const SceneHandle& from, const Settings& settings) {
  SceneHandle handle = from;
  for (const auto& [path, value] : settings) {
    // An earlier value of that name is removed: two values of one name would be refused.
    std::erase_if(handle.settings, [&name = path](const Setting& one) { return one.path == name; });
    handle.settings.push_back({path, value});
  }
  handle.scene = handle.document->read(*handle.registry, handle.settings);
  return handle;
}

std::string tradeoff(const SceneHandle& handle, const std::string& observable, double tolerance,
                     double budget, const py::object& progress) {
  InterruptGuard guard;
  ProgressCall show(progress);
  TradeoffRequest request{observable, tolerance, budget, &guard.stop()};
  if (show) request.on_progress = [&](const std::string& what) { show(guard.stop(), what); };
  std::string json = without_lock([&] {
    return tradeoff_json(*handle.scene, measure_tradeoff(handle.scene, *handle.registry, request));
  });
  show.rethrow();
  return json;
}

py::tuple compare(const std::vector<SceneHandle>& handles, const std::string& observable,
                  double tolerance, const py::object& progress) {
  InterruptGuard guard;
  ProgressCall show(progress);
  std::vector<std::shared_ptr<const Scene>> scenes;
  scenes.reserve(handles.size());
  for (const SceneHandle& handle : handles) scenes.push_back(handle.scene);
  CompareRequest request{observable, tolerance, &guard.stop()};
  if (show) request.on_progress = [&](const std::string& what) { show(guard.stop(), what); };
  const Comparison comparison = without_lock([&] { return compare_models(scenes, request); });
  show.rethrow();
  py::list curves;
  for (const ComparedModel& model : comparison.models) {
    curves.append(py::make_tuple(py::array(py::cast(model.way)), py::array(py::cast(model.force))));
  }
  return py::make_tuple(compare_json(comparison), curves);
}

}  // namespace

void define_scenes(py::module_& module) {
  const auto standard = std::make_shared<const Registry>(standard_registry());
  py::class_<SceneHandle> scene(module, "Scene");
  define_figures(module, scene);
  scene.def("with_settings", &with_settings)
      .def_property_readonly("file", [](const SceneHandle& it) { return text_of(it.scene->file); })
      .def_property_readonly("name", [](const SceneHandle& it) { return it.scene->name; })
      .def_property_readonly("source", [](const SceneHandle& it) { return it.scene->source; })
      .def_property_readonly("dimension", [](const SceneHandle& it) { return it.scene->dimension; })
      .def_property_readonly(
          "units", [](const SceneHandle& it) { return std::string(to_string(it.scene->units)); })
      .def_property_readonly("axes",
                             [](const SceneHandle& it) {
                               const AxisUnits& axes = it.scene->axes;
                               py::dict names;
                               names["length"] = axes.length;
                               names["time"] = axes.time;
                               names["mass"] = axes.mass;
                               names["velocity"] = axes.velocity;
                               names["force"] = axes.force;
                               names["energy"] = axes.energy;
                               return names;
                             })
      .def_property_readonly("duration",
                             [](const SceneHandle& it) { return it.scene->run.duration; })
      .def_property_readonly("parameters",
                             [](const SceneHandle& it) {
                               py::dict all;
                               for (const auto& [name, value] : it.scene->parameters) {
                                 all[py::str(name)] = value;
                               }
                               return all;
                             })
      .def_property_readonly("settings",
                             [](const SceneHandle& it) {
                               Settings all;
                               for (const Setting& one : it.settings) {
                                 all.emplace_back(one.path, one.value);
                               }
                               return all;
                             })
      .def_property_readonly("plugins",
                             [](const SceneHandle& it) {
                               py::list all;
                               for (const std::string& one : it.plugins) all.append(py::bytes(one));
                               return all;
                             })
      .def_property_readonly("file_bytes",
                             [](const SceneHandle& it) { return py::bytes(it.scene->file); })
      .def_property_readonly("text", [](const SceneHandle& it) { return it.document->text(); })
      .def_property_readonly("effective_toml",
                             [](const SceneHandle& it) { return it.scene->effective_toml; })
      .def("explain_json",
           [](const SceneHandle& it, double seconds) {
             return without_lock([&] { return explanation_json(explain(it.scene, seconds)); });
           })
      .def("check_json",
           [](const SceneHandle& it, std::uint64_t seed) {
             InterruptGuard guard;
             std::string json =
                 without_lock([&] { return check_json(it.scene, seed, &guard.stop()); });
             if (guard.stop()) {
               PyErr_SetNone(PyExc_KeyboardInterrupt);
               throw py::error_already_set();
             }
             return json;
           })
      .def("tradeoff_json", &tradeoff);
  module.def("read_file",
             [standard](const std::string& file, const std::vector<std::string>& plugins) {
               return read(std::make_shared<const SceneDocument>(file), plugins, standard);
             });
  module.def("read_text", [standard](std::string text, std::string file,
                                     const std::vector<std::string>& plugins) {
    return read(std::make_shared<const SceneDocument>(std::move(text), std::move(file)), plugins,
                standard);
  });
  module.def("compare", &compare);
}

}  // namespace tomlin::python
