#include "framework/plugin/kim/kim_model.hpp"
#include "framework/plugin/plugin.hpp"

TOMLIN_PLUGIN(registry) { registry.add(tomlin::kim_model_record()); }
