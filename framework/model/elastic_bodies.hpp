#pragma once

#include <string>
#include <vector>

#include "framework/core/system/elastic.hpp"
#include "framework/model/assembly.hpp"

namespace tomlin {

/// Whether a force acts as bonds within one body of particles: then a scheme that splits bonds off
/// takes it as part of the operator.
bool is_bonds(const Assembly<double>& assembly, const Assembly<double>::Force& force);

/// All moving bodies with their bonds linearised about the start. `fault` says why a scene has
/// none, and is empty otherwise.
std::vector<ElasticBody> elastic_bodies(Assembly<double>& assembly, std::string& fault);

}  // namespace tomlin
