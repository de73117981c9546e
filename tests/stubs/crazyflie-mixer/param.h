/* Parameters are not set while it mixes. */
#pragma once
#include <stdint.h>
#define PARAM_GROUP_START(NAME)
#define PARAM_ADD_CORE(TYPE, NAME, ADDRESS)
#define PARAM_GROUP_STOP(NAME)
