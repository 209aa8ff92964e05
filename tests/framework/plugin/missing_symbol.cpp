#include "framework/plugin/plugin.hpp"

// Calls what nobody has defined.
tomlin::ForceRecord forgotten_record();

TOMLIN_PLUGIN(registry) { registry.add(forgotten_record()); }
