/* A parameter is a name with an address. */
#pragma once
#include <stdint.h>

#define PARAM_UINT8 0x08
#define PARAM_UINT16 0x09
#define PARAM_FLOAT 0x06
struct param_s { uint8_t type; const char *name; void *address; void (*callback)(void); };
#define PARAM_GROUP_START(NAME) static struct param_s __params_##NAME[] __attribute__((used)) = { { 0x80, #NAME, 0, 0 },
#define PARAM_ADD(TYPE, NAME, ADDRESS) { TYPE, #NAME, (void *)(ADDRESS), 0 },
#define PARAM_ADD_WITH_CALLBACK(TYPE, NAME, ADDRESS, CALLBACK) { TYPE, #NAME, (void *)(ADDRESS), CALLBACK },
#define PARAM_GROUP_STOP(NAME) };
