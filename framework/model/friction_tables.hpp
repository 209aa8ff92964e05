#pragma once

#include "framework/core/elements/kernel_tables.hpp"
#include "framework/model/friction_kernels.hpp"

TOMLIN_DECLARE_TABLES(FrictionKernels, FrictionTable)
