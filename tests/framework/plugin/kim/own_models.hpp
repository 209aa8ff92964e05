#pragma once

#include <cstdlib>

namespace tomlin::test {

/// Lets the KIM API find the models of the tests, and keeps its settings out of the user's home.
inline void use_own_models() {
  ::setenv("KIM_API_PORTABLE_MODELS_DIR", TOMLIN_KIM_FOLDER "/models", 1);
  ::setenv("KIM_API_CONFIGURATION_FILE", TOMLIN_KIM_FOLDER "/kim-api.conf", 1);
}

}  // namespace tomlin::test
