#pragma once

/// All that a program needs to read scenes, run them and read their results: standard_registry(),
/// read_scene() and parse_scene(), run() and RunResult, observable(), and the errors they throw;
/// SceneDocument, where one text is read with many values.
///
/// A scene keeps pointers to the registry it was read with, which has to outlive it and to stay
/// where it is. Numbers are in the scene's units, angles in rad unless a name says turns. Bad input
/// throws InputError with every fault found; a run that fails numerically throws nothing, but has
/// the status failed.

#include "framework/core/text/fault.hpp"
#include "framework/run/results/observables.hpp"
#include "framework/run/run.hpp"
#include "framework/scene/scene.hpp"
#include "framework/scene/scene_document.hpp"
#include "framework/standard_registry.hpp"
#include "framework/study/accuracy/accuracy.hpp"
